#include "io/measured/frf_suspicions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>

#include "base/upper_median.h"
#include "io/scan.h"

namespace chladni::io {
namespace {

using Complex = std::complex<double>;
using Index = Eigen::Index;
constexpr double kClear = 0.5;  // limit of turning and side; noise alone stays far below it
constexpr Index kFewest = 16;   // the fewest lines that can show it

bool is_known(const Complex& value) {
  return std::isfinite(value.real()) && std::isfinite(value.imag());
}

// G/s^n: the response as a receptance, up to a positive factor per line.
Complex as_receptance(const modal::FrfSet& set, Index k, Index i, Index j,
                      bool conjugated = false) {
  Complex value = set.value[static_cast<std::size_t>(k)](i, j);
  if (conjugated) value = std::conj(value);
  switch (set.outputs[static_cast<std::size_t>(i)].kind) {
    case modal::FrfKind::mobility:
      return value * Complex(0.0, -1.0);
    case modal::FrfKind::accelerance:
      return -value;
    default:
      return value;
  }
}

std::string name_of(const modal::FrfSet& set, Index i, Index j) {
  return set.outputs[static_cast<std::size_t>(i)].name + "/" +
         set.inputs[static_cast<std::size_t>(j)].name;
}

std::string place(const modal::FrfSet& set, Index k) {
  return fmt::format("line {} ({:.9g} Hz)", k + 1, set.frequency_hz(k));
}

/// The numbers of unknown and zero lines of one response, and the first of each.
struct Count {
  Index unknown = 0, zero = 0, first_unknown = -1, first_zero = -1;
};

Count count(const modal::FrfSet& set, Index i, Index j) {
  Count result;
  for (Index k = 0; k < set.line_count(); ++k) {
    const Complex value = set.value[static_cast<std::size_t>(k)](i, j);
    if (!is_known(value)) {
      if (result.unknown++ == 0) result.first_unknown = k;
    } else if (value == 0.0 && set.frequency_hz(k) > 0.0) {
      if (result.zero++ == 0) result.first_zero = k;
    }
  }
  return result;
}

std::string times(Index count) { return fmt::to_string(count) + (count == 1 ? " line" : " lines"); }

// Whether the stated variance is more than the square of the response on every line that has both.
bool is_drowned(const modal::FrfSet& set, Index i, Index j) {
  bool any = false;
  for (std::size_t k = 0; k < set.variance.size(); ++k) {
    const double square = std::norm(set.value[k](i, j));
    const double variance = set.variance[k](i, j);
    if (!std::isfinite(square) || !(variance > 0.0)) continue;
    if (variance <= square) return false;
    any = true;
  }
  return any;
}

// The gaps in one response, one sentence each.
std::vector<std::string> gaps_of(const modal::FrfSet& set, Index i, Index j) {
  const Count found = count(set, i, j);
  if (found.unknown == set.line_count()) return {"not measured"};
  std::vector<std::string> gaps;
  if (found.unknown > 0) {
    gaps.push_back("no value on " + times(found.unknown) + ", the first is " +
                   place(set, found.first_unknown));
  }
  if (found.zero > 0 && found.zero + found.unknown + 1 >= set.line_count()) {
    gaps.emplace_back("zero on all lines");
  } else if (found.zero > 0) {
    gaps.push_back("exactly zero on " + times(found.zero) + ", the first is " +
                   place(set, found.first_zero));
  }
  if (is_drowned(set, i, j)) {
    gaps.emplace_back(
        "its variance is more than its square on all lines, so that every fit comes down to it");
  }
  return gaps;
}

void add_gaps(const modal::FrfSet& set, std::vector<std::string>& said) {
  std::map<std::string, std::vector<std::string>> alike;  // a sentence, and the responses it is for
  for (Index i = 0; i < set.output_count(); ++i) {
    for (Index j = 0; j < set.input_count(); ++j) {
      for (const auto& gap : gaps_of(set, i, j)) alike[gap].push_back(name_of(set, i, j));
    }
  }
  const auto all = static_cast<std::size_t>(set.output_count() * set.input_count());
  for (const auto& [what, whose] : alike) {
    const bool everywhere = whose.size() == all && all > 1;
    said.push_back((everywhere ? "all responses" : listed(whose)) + ": " + what);
  }
}

// The numbers of a response, 0 where it is not known; empty where all numbers are zero.
std::vector<double> numbers_of(const modal::FrfSet& set, Index i, Index j) {
  std::vector<double> numbers;
  bool any = false;
  for (const auto& line : set.value) {
    const Complex value = is_known(line(i, j)) ? line(i, j) : Complex(0.0);
    numbers.push_back(value.real());
    numbers.push_back(value.imag());
    any = any || value != 0.0;
  }
  return any ? numbers : std::vector<double>();
}

// Reports responses that are equal in every line.
void add_copies(const modal::FrfSet& set, std::vector<std::string>& said) {
  std::map<std::vector<double>, std::vector<std::string>> alike;
  for (Index i = 0; i < set.output_count(); ++i) {
    for (Index j = 0; j < set.input_count(); ++j) {
      auto key = numbers_of(set, i, j);
      if (!key.empty()) alike[std::move(key)].push_back(name_of(set, i, j));
    }
  }
  for (auto& [key, names] : alike) {
    if (names.size() == 1) continue;
    const std::string first = names.front();
    names.erase(names.begin());
    const bool one = names.size() == 1;
    said.push_back(listed(names) + (one ? " is" : " are") + " the same as " + first +
                   " on every line: " + (one ? "one of them is a copy" : "they are copies"));
  }
}

// The largest expected change between two lines. Away from resonances, a receptance, mobility or
// accelerance of one oscillator changes by at most the fourth power of the frequency ratio.
double most_by_frequency(double a, double b) {
  const double ratio = std::max(a, b) / std::min(a, b);
  return std::pow(ratio, 4.0);
}

// The ratio of a value to the median of the two values on either side; 0 where it is not known.
double over_neighbours(const modal::FrfSet& set, Index k, Index i, Index j) {
  const auto size = [&](Index line) {
    return std::abs(set.value[static_cast<std::size_t>(line)](i, j));
  };
  std::vector<double> around;
  double allowed = 1.0;
  for (Index line = std::max<Index>(k - 2, 0); line <= std::min(k + 2, set.line_count() - 1);
       ++line) {
    if (line == k || set.frequency_hz(line) == 0.0 || !std::isfinite(size(line))) continue;
    around.push_back(size(line));
    allowed = std::max(allowed, most_by_frequency(set.frequency_hz(line), set.frequency_hz(k)));
  }
  if (around.size() < 2 || set.frequency_hz(k) == 0.0) return 0.0;
  const double middle = upper_median(around);
  return middle > 0.0 ? size(k) / middle / allowed : 0.0;
}

// Reports single values far above their neighbours, for example from a wrong exponent or bit.
void add_spikes(const modal::FrfSet& set, std::vector<std::string>& said) {
  constexpr double clear = 1e6;
  std::vector<std::string> names;
  std::string first;
  Index count = 0;
  for (Index i = 0; i < set.output_count(); ++i) {
    for (Index j = 0; j < set.input_count(); ++j) {
      const Index before = count;
      for (Index k = 0; k < set.line_count(); ++k) {
        if (over_neighbours(set, k, i, j) > clear && count++ == 0) first = place(set, k);
      }
      if (count > before) names.push_back(name_of(set, i, j));
    }
  }
  if (names.empty()) return;
  said.push_back(listed(names) + ": more than a million times the neighbours on " + times(count) +
                 ", the first is " + first);
}

// +1: output and input have the same place and direction; −1: the same place and opposite
// directions; 0: they are not collocated.
int collocation(const modal::FrfSet& set, Index i, Index j,
                const std::vector<std::pair<std::string, std::string>>& pairs) {
  const auto& output = set.outputs[static_cast<std::size_t>(i)];
  const auto& input = set.inputs[static_cast<std::size_t>(j)];
  for (const auto& pair : pairs) {
    if (pair.first == output.name && pair.second == input.name) return 1;
  }
  if (!output.node || output.node != input.node) return 0;
  const double along = output.direction.dot(input.direction);
  return along > 0.99 ? 1 : along < -0.99 ? -1 : 0;
}

}  // namespace

double turning(const modal::FrfSet& set, Index output, Index input) {
  double turned = 0.0;
  double size = 0.0;
  for (Index k = 0; k + 1 < set.line_count(); ++k) {
    const Complex a = as_receptance(set, k, output, input);
    const Complex b = as_receptance(set, k + 1, output, input);
    if (!is_known(a) || !is_known(b)) continue;
    const double area = (std::conj(a) * b).imag();
    turned += area;
    size += std::abs(area);
  }
  return size > 0.0 ? turned / size : 0.0;
}

double side(const modal::FrfSet& set, Index output, Index input, bool conjugated) {
  double above = 0.0;
  double size = 0.0;
  for (Index k = 0; k < set.line_count(); ++k) {
    const Complex value = as_receptance(set, k, output, input, conjugated);
    if (!is_known(value) || set.frequency_hz(k) == 0.0) continue;
    above += value.imag();
    size += std::abs(value.imag());
  }
  return size > 0.0 ? above / size : 0.0;
}

namespace {

using Pairs = std::vector<std::pair<std::string, std::string>>;

// The responses that turn the wrong way, and the responses whose sign is turned.
struct Phases {
  std::vector<std::string> conjugated, turned;
};

void judge(const modal::FrfSet& set, Index i, Index j, const Pairs& collocated, Phases& phases) {
  const double turn = turning(set, i, j);
  if (std::abs(turn) < kClear) return;
  const bool conjugated = turn > 0.0;
  if (conjugated) phases.conjugated.push_back(name_of(set, i, j));
  const int expected = collocation(set, i, j, collocated);
  if (expected * side(set, i, j, conjugated) > kClear) phases.turned.push_back(name_of(set, i, j));
}

}  // namespace

std::vector<std::string> suspicions(const modal::FrfSet& set, const Pairs& collocated) {
  std::vector<std::string> said;
  add_gaps(set, said);
  add_copies(set, said);
  add_spikes(set, said);
  if (set.line_count() < kFewest) return said;
  Phases phases;
  for (Index i = 0; i < set.output_count(); ++i) {
    for (Index j = 0; j < set.input_count(); ++j) judge(set, i, j, collocated, phases);
  }
  if (!phases.conjugated.empty()) {
    said.push_back(listed(phases.conjugated) +
                   (phases.conjugated.size() == 1 ? " looks" : " look") +
                   " conjugated: the phase rises through the resonances, e^{-jwt}?");
  }
  constexpr std::size_t most = 12;  // one line each
  for (std::size_t n = 0; n < std::min(phases.turned.size(), most); ++n) {
    said.push_back(phases.turned[n] +
                   " looks as if its sign were turned: sensor and actuator are one place and its "
                   "phase lies in the wrong half plane");
  }
  if (phases.turned.size() > most) {
    said.push_back("so do " + fmt::to_string(phases.turned.size() - most) + " more");
  }
  return said;
}

}  // namespace chladni::io
