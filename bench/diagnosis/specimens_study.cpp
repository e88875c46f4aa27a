// specimens_study [--seeds A..B] [--hidden none,thickness,mass] [--specimens N] [--frequencies]
//   [--scatter STIFFNESS,DENSITY] [--change LEAST,MOST] [--shared X] [--own X] [--errors] [--told]
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <cstdio>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "diagnosis/specimens.h"
#include "simulators/series/plate_series.h"

namespace chladni {
namespace {

constexpr const char* kHelp =
    R"(specimens_study [--seeds A..B] [--hidden none,thickness,mass] [--specimens N] [--frequencies]
  [--scatter STIFFNESS,DENSITY] [--change LEAST,MOST] [--shared X] [--own X] [--errors] [--told]

Series of plates of one design with one wrong entry (or none), diagnosed together. The plates are of
a Ritz solution that varies over the plate; the model is uniform.

Seeds 1 to 20 are for tuning. Seeds from 1000 on are for reports: do not tune on them.

One line for each series: seed, what is hidden, verdict, whether the right entry is named, whether
it is the likeliest, its probability, that of "none", what the entry is found to be against the
truth in stated deviations, levels of the model's errors, seconds. Then totals.

--frequencies: no shapes. --errors: the errors of the model instead of a diagnosis.
)";

struct Arguments {
  unsigned first = 1, last = 20;
  std::vector<std::string> hidden{"none", "thickness", "mass"};
  simulators::PlateSeriesOptions options;
  bool errors = false, told = false;
};

std::vector<std::string> parts_of(const std::string& text, char between) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, between);) parts.push_back(part);
  return parts;
}

std::pair<double, double> two_of(const std::string& text) {
  const auto parts = parts_of(text, ',');
  require(parts.size() == 2, text + ": expected two numbers with a comma");
  return {std::stod(parts[0]), std::stod(parts[1])};
}

Arguments arguments_of(const std::vector<std::string>& words) {
  Arguments wanted;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto& word = words[i];
    if (word == "--frequencies") {
      wanted.options.shapes = false;
    } else if (word == "--errors") {
      wanted.errors = true;
    } else if (word == "--told") {
      wanted.told = true;
    } else {
      require(i + 1 < words.size(), word + ": expected a value, or one of\n" + kHelp);
      const auto& value = words[++i];
      if (word == "--seeds") {
        const auto dots = value.find("..");
        require(dots != std::string::npos, "--seeds: expected A..B");
        wanted.first = static_cast<unsigned>(std::stoul(value.substr(0, dots)));
        wanted.last = static_cast<unsigned>(std::stoul(value.substr(dots + 2)));
      } else if (word == "--hidden") {
        wanted.hidden = parts_of(value, ',');
      } else if (word == "--specimens") {
        wanted.options.specimens = std::stoi(value);
      } else if (word == "--scatter") {
        std::tie(wanted.options.stiffness_scatter, wanted.options.density_scatter) = two_of(value);
      } else if (word == "--change") {
        std::tie(wanted.options.least, wanted.options.most) = two_of(value);
      } else if (word == "--shared") {
        wanted.options.shared = std::stod(value);
      } else if (word == "--own") {
        wanted.options.own = std::stod(value);
      } else {
        throw InvalidInput(word + ": expected one of\n" + kHelp);
      }
    }
  }
  return wanted;
}

struct Total {
  int series = 0, named = 0, first = 0, accused = 0, within_two = 0;
};

bool is_truth(const simulators::PlateSeries& series, const diagnosis::OddEntry& entry) {
  return series.odd >= 0 &&
         entry.specimen == series.specimens[static_cast<std::size_t>(series.odd)].name &&
         entry.effect == series.odd_effect;
}

void score(const simulators::PlateSeries& series, const diagnosis::SpecimensDiagnosis& found,
           const std::string& line, double seconds, Total& total) {
  const bool is_sure =
      found.verdict == diagnosis::Verdict::named || found.verdict == diagnosis::Verdict::partial;
  bool named = false, wrong = false, first = false;
  double probability = 0.0, off = std::nan("");
  for (const auto& entry : found.best.entries) {
    const bool is_right = is_truth(series, entry);
    named = named || (is_sure && is_right && entry.probability >= 0.8);
    wrong = wrong || (is_sure && !is_right && entry.probability >= 0.8);
  }
  if (!found.entries.empty()) first = is_truth(series, found.entries.front());
  for (const auto& entry : found.entries) {
    if (!is_truth(series, entry)) continue;
    probability = entry.probability;
    off = (std::log(entry.value / entry.of_study) - series.odd_change) * entry.value / entry.std;
  }
  ++total.series;
  total.named += named ? 1 : 0;
  total.first += first ? 1 : 0;
  total.accused += wrong ? 1 : 0;
  total.within_two += std::abs(off) < 2.0 ? 1 : 0;
  fmt::print(
      "{} {:<14} {} {} p {:.3f} none {:.3f} truth {:+.1f} % off by {:+.1f} shared {:.2f} % "
      "own {:.2f} % {:.1f} s{}\n",
      line, diagnosis::name(found.verdict),
      named   ? "named"
      : wrong ? "WRONG"
              : "-",
      first ? "first" : "-", probability, found.none, 100.0 * std::expm1(series.odd_change), off,
      100.0 * found.shared_error, 100.0 * found.own_error, seconds,
      wrong ? fmt::format(" ({} of {})", found.best.entries.front().effect,
                          found.best.entries.front().specimen)
            : "");
  std::fflush(stdout);
}

void tell(const diagnosis::SpecimensDiagnosis& found) {
  for (const auto& one : found.population) {
    fmt::print("  {} mean {:.4g} spread {:.3f}\n", one.name, one.mean, one.spread);
  }
  for (const auto& one : found.entries) {
    if (one.probability < 0.01) break;
    fmt::print("  {} of {}: p {:.3f} lnB {:.1f} {:+.1f} %\n", one.key, one.specimen,
               one.probability, one.log_evidence, 100.0 * one.change());
  }
  if (!found.best.unlike.empty()) fmt::print("  unlike: {}\n", found.best.unlike);
  for (const auto& note : found.notes) fmt::print("  {}\n", note);
}

void run(const Arguments& wanted) {
  std::map<std::string, Total> totals;
  for (unsigned seed = wanted.first; seed <= wanted.last; ++seed) {
    if (wanted.errors) {
      const auto errors = simulators::errors_of_series(seed, wanted.options);
      fmt::print("{} shared {:.2f} % own {:.2f} %\n", seed, 100.0 * errors.shared,
                 100.0 * errors.own);
      continue;
    }
    for (const auto& hidden : wanted.hidden) {
      const auto series = simulators::plate_series(seed, hidden, wanted.options);
      const auto start = std::chrono::steady_clock::now();
      const auto found = diagnosis::diagnosed(series.specimens);
      const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
      score(series, found, fmt::format("{} {:<9}", seed, hidden), took.count(), totals[hidden]);
      if (wanted.told) tell(found);
    }
  }
  for (const auto& [hidden, total] : totals) {
    fmt::print(
        "{}: {} series, right sheet and entry named {}, likeliest {}, another accused {}, "
        "size within two deviations {}\n",
        hidden, total.series, total.named, total.first, total.accused, total.within_two);
  }
}

}  // namespace
}  // namespace chladni

int main(int count, char** words) {
  try {
    chladni::run(chladni::arguments_of({words + 1, words + count}));
    return 0;
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 2;
  }
}
