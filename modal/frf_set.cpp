#include "modal/frf_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <set>
#include <string_view>

#include "base/error.h"

namespace chladni::modal {
namespace {

using Complex = std::complex<double>;

std::string sized(Eigen::Index rows, Eigen::Index columns) {
  return fmt::to_string(rows) + " x " + fmt::to_string(columns);
}

void check_channels(const std::vector<MeasuredChannel>& channels, const std::string& side) {
  require(!channels.empty(), "measured responses: there is no " + side);
  std::set<std::string_view> names;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const auto& channel = channels[c];
    const std::string place = "measured responses: " + side + " " + fmt::to_string(c + 1);
    require(!channel.name.empty(), place + " has no name");
    require(names.insert(channel.name).second,
            "measured responses: two " + side + "s are called \"" + channel.name + "\"");
    const double length = channel.direction.norm();
    require(length == 0.0 || std::abs(length - 1.0) < 1e-6,
            place + " (\"" + channel.name + "\"): its direction has the length " +
                fmt::to_string(length) + ", expected 1, or 0 where it is not stated");
    require(!channel.position || channel.position->allFinite(),
            place + " (\"" + channel.name + "\"): its position is not finite");
  }
}

void check_lines(const Eigen::VectorXd& frequency_hz) {
  for (Eigen::Index k = 0; k < frequency_hz.size(); ++k) {
    const double before = k == 0 ? -1.0 : frequency_hz(k - 1);
    if (std::isfinite(frequency_hz(k)) && frequency_hz(k) >= 0.0 && frequency_hz(k) > before) {
      continue;
    }
    throw InvalidInput("measured responses: line " + fmt::to_string(k + 1) + " is at " +
                       fmt::to_string(frequency_hz(k)) + " Hz" +
                       (k == 0 ? "" : ", the one before it at " + fmt::to_string(before) + " Hz") +
                       "; expected ascending frequencies, 0 or more");
  }
}

template <typename Matrix>
void check_sizes(const std::vector<Matrix>& of, const FrfSet& set, const std::string& what) {
  require(static_cast<Eigen::Index>(of.size()) == set.line_count(),
          "measured responses: " + what + " on " + fmt::to_string(of.size()) + " lines, expected " +
              fmt::to_string(set.line_count()) + ", one per frequency");
  for (std::size_t k = 0; k < of.size(); ++k) {
    if (of[k].rows() == set.output_count() && of[k].cols() == set.input_count()) continue;
    throw InvalidInput(
        "measured responses: " + what + " on line " + fmt::to_string(k + 1) + " is " +
        sized(of[k].rows(), of[k].cols()) +
        ", expected outputs x inputs: " + sized(set.output_count(), set.input_count()));
  }
}

[[noreturn]] void refuse(const FrfSet& set, std::size_t k, Eigen::Index i, Eigen::Index j,
                         const std::string& found) {
  throw InvalidInput("measured responses: " + set.outputs[static_cast<std::size_t>(i)].name + "/" +
                     set.inputs[static_cast<std::size_t>(j)].name + ", line " +
                     fmt::to_string(k + 1) + ": " + found);
}

void check_range(const std::vector<Eigen::MatrixXd>& of, const FrfSet& set, const std::string& what,
                 double highest, const std::string& expected) {
  if (of.empty()) return;
  check_sizes(of, set, what);
  for (std::size_t k = 0; k < of.size(); ++k) {
    for (Eigen::Index j = 0; j < set.input_count(); ++j) {
      for (Eigen::Index i = 0; i < set.output_count(); ++i) {
        const double value = of[k](i, j);
        if (!(value < 0.0 || value > highest)) continue;
        refuse(set, k, i, j, what + " is " + fmt::to_string(value) + ", expected " + expected);
      }
    }
  }
}

void check_values(const FrfSet& set) {
  check_sizes(set.value, set, "the response");
  for (std::size_t k = 0; k < set.value.size(); ++k) {
    for (Eigen::Index j = 0; j < set.input_count(); ++j) {
      for (Eigen::Index i = 0; i < set.output_count(); ++i) {
        const Complex value = set.value[k](i, j);
        if (!std::isinf(value.real()) && !std::isinf(value.imag())) continue;
        refuse(set, k, i, j,
               "the response is infinite, expected a number, or NaN where it was "
               "not measured");
      }
    }
  }
}

constexpr std::array<std::string_view, 3> kPerTime{"", "/s", "/s^2"};

int steps_of(FrfKind from, FrfKind to) { return static_cast<int>(to) - static_cast<int>(from); }

// "m/s^2" as a receptance is "m"; other units get the factor of time appended.
std::string converted_unit(const std::string& unit, FrfKind from, FrfKind to) {
  if (unit.empty() || from == to) return unit;
  const auto ending = kPerTime[static_cast<std::size_t>(from)];
  const int steps = steps_of(from, to);
  if (unit.ends_with(ending) &&
      (from != FrfKind::receptance || unit.find('/') == std::string_view::npos)) {
    return unit.substr(0, unit.size() - ending.size()) +
           std::string(kPerTime[static_cast<std::size_t>(to)]);
  }
  return unit + (steps > 0 ? "/s" : " s") + (std::abs(steps) == 2 ? "^2" : "");
}

// Multiplies one row by s^steps.
void differentiate(FrfSet& set, Eigen::Index output, int steps) {
  for (Eigen::Index k = 0; k < set.line_count(); ++k) {
    const auto line = static_cast<std::size_t>(k);
    const Complex s(0.0, 2.0 * std::numbers::pi * set.frequency_hz(k));
    const Complex times = std::abs(steps) == 2 ? Complex(-std::norm(s)) : s;
    const Complex factor = steps < 0 ? 1.0 / times : times;
    set.value[line].row(output) *= factor;
    if (!set.variance.empty()) set.variance[line].row(output) *= std::norm(factor);
    if (!set.noise_variance.empty()) set.noise_variance[line].row(output) *= std::norm(factor);
  }
}

FrfSet of_lines(const FrfSet& set, Eigen::Index first, Eigen::Index count) {
  FrfSet result;
  result.outputs = set.outputs;
  result.inputs = set.inputs;
  result.averages = set.averages;
  result.frequency_hz = set.frequency_hz.segment(first, count);
  const auto cut = [&](auto& of, const auto& whole) {
    if (!whole.empty()) of.assign(whole.begin() + first, whole.begin() + first + count);
  };
  cut(result.value, set.value);
  cut(result.variance, set.variance);
  cut(result.noise_variance, set.noise_variance);
  cut(result.coherence, set.coherence);
  return result;
}

void check_chosen(const std::vector<Eigen::Index>& chosen, Eigen::Index count,
                  const std::string& side) {
  for (const auto i : chosen) {
    require(i >= 0 && i < count, "measured responses: " + side + " " + fmt::to_string(i) +
                                     " is asked for, expected 0 to " + fmt::to_string(count - 1));
  }
}

}  // namespace

void check(const FrfSet& set) {
  check_channels(set.outputs, "output");
  check_channels(set.inputs, "input");
  check_lines(set.frequency_hz);
  check_values(set);
  constexpr double most = std::numeric_limits<double>::max();
  check_range(set.variance, set, "the variance", most, "0 or more");
  check_range(set.noise_variance, set, "the noise variance", most, "0 or more");
  check_range(set.coherence, set, "the coherence", 1.0, "0 to 1");
  require(std::isfinite(set.averages) && set.averages >= 0.0,
          "measured responses: the variance has " + fmt::to_string(set.averages) +
              " degrees of freedom, expected 0 or more");
}

std::vector<std::string> names_of(const std::vector<MeasuredChannel>& channels) {
  std::vector<std::string> names;
  for (const auto& channel : channels) names.push_back(channel.name);
  return names;
}

FrfSet converted(const FrfSet& set, FrfKind kind) {
  bool integrated = false;
  for (const auto& output : set.outputs) integrated = integrated || steps_of(output.kind, kind) < 0;
  const bool at_rest = integrated && set.line_count() > 0 && set.frequency_hz(0) == 0.0;
  FrfSet result = of_lines(set, at_rest ? 1 : 0, set.line_count() - (at_rest ? 1 : 0));
  for (std::size_t i = 0; i < result.outputs.size(); ++i) {
    auto& output = result.outputs[i];
    const int steps = steps_of(output.kind, kind);
    if (steps != 0) differentiate(result, static_cast<Eigen::Index>(i), steps);
    output.unit = converted_unit(output.unit, output.kind, kind);
    output.kind = kind;
  }
  return result;
}

FrfSet part(const FrfSet& set, const std::vector<Eigen::Index>& outputs,
            const std::vector<Eigen::Index>& inputs) {
  check_chosen(outputs, set.output_count(), "output");
  check_chosen(inputs, set.input_count(), "input");
  FrfSet result;
  for (const auto i : outputs) result.outputs.push_back(set.outputs[static_cast<std::size_t>(i)]);
  for (const auto j : inputs) result.inputs.push_back(set.inputs[static_cast<std::size_t>(j)]);
  result.frequency_hz = set.frequency_hz;
  result.averages = set.averages;
  const auto choose = [&](auto& of, const auto& whole) {
    of.reserve(whole.size());
    for (const auto& line : whole) of.emplace_back(line(outputs, inputs));
  };
  choose(result.value, set.value);
  choose(result.variance, set.variance);
  choose(result.noise_variance, set.noise_variance);
  choose(result.coherence, set.coherence);
  return result;
}

FrfSet band(const FrfSet& set, double low_hz, double high_hz) {
  const auto* begin = set.frequency_hz.data();
  const auto* end = begin + set.line_count();
  const auto first = std::lower_bound(begin, end, low_hz) - begin;
  const auto last = std::upper_bound(begin, end, high_hz) - begin;
  require(first < last, "measured responses: no line from " + fmt::to_string(low_hz) + " to " +
                            fmt::to_string(high_hz) + " Hz" +
                            (begin == end ? "; there are no lines"
                                          : "; they go from " + fmt::to_string(*begin) + " to " +
                                                fmt::to_string(*(end - 1)) + " Hz"));
  return of_lines(set, first, last - first);
}

FrfSet outside_band(const FrfSet& set, double low_hz, double high_hz) {
  const auto* begin = set.frequency_hz.data();
  const auto* end = begin + set.line_count();
  const auto below = std::lower_bound(begin, end, low_hz) - begin;
  const auto above = end - std::upper_bound(begin, end, high_hz);
  require(below + above > 0, "measured responses: no line outside " + fmt::to_string(low_hz) +
                                 " to " + fmt::to_string(high_hz) + " Hz");
  FrfSet both = of_lines(set, 0, below);
  const FrfSet rest = of_lines(set, set.line_count() - above, above);
  Eigen::VectorXd frequency(below + above);
  frequency << both.frequency_hz, rest.frequency_hz;
  both.frequency_hz = frequency;
  const auto append = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  append(both.value, rest.value);
  append(both.variance, rest.variance);
  append(both.noise_variance, rest.noise_variance);
  append(both.coherence, rest.coherence);
  return both;
}

}  // namespace chladni::modal
