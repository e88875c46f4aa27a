// A diagnosis of several specimens as text.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "show/readable.h"
#include "show/specimens.h"

namespace chladni::show {
namespace {

using diagnosis::CalibratedNumber;
using diagnosis::OddEntry;
using diagnosis::SpecimensDiagnosis;

constexpr std::size_t kRivalsTold = 5;
constexpr double kRivalTold = 0.005;  // probability

// Enough decimals to show the deviation to two digits of its own.
int decimals_for(double std) {
  return std > 0.0 && std::isfinite(std)
             ? std::clamp(1 - static_cast<int>(std::floor(std::log10(std))), 0, 9)
             : 3;
}

std::string with_deviation(double value, double std, const std::string& between) {
  const int digits = decimals_for(std);
  return fmt::format("{:.{}f}{}{}", value, digits, between,
                     deviation_text(std, fmt::format("{{:.{}f}}", digits)));
}

std::string name_of(const OddEntry& one) { return fmt::format("{} of {}", one.key, one.specimen); }

std::string told_explanation(const diagnosis::SpecimensExplanation& one) {
  if (!one.unlike.empty()) {
    return fmt::format("{} is not of this design: its {} differ", one.unlike,
                       one.by_modes ? "frequencies" : "constants");
  }
  if (one.entries.empty()) return "every entry is right";
  std::string text;
  for (const auto& entry : one.entries) text += (text.empty() ? "" : "; and ") + entry_text(entry);
  return text;
}

std::string population_text(const SpecimensDiagnosis& result) {
  std::string text = "population:\n";
  for (const auto& one : result.population) {
    const auto [factor, unit] = readable_constant(one.unit, one.mean);
    text += fmt::format("  {}: mean {}{}{}, specimens scatter {:.2g} %", one.name,
                        with_deviation(factor * one.mean, factor * one.std, " +- "),
                        unit.empty() ? "" : " ", unit, 100.0 * one.spread);
    if (one.within_group > 0.0) {
      text += fmt::format(" from group to group, {:.2g} % inside one", 100.0 * one.within_group);
    }
    text += one.determined ? "\n" : ", not determined\n";
  }
  return result.population.empty() ? "" : text;
}

// The number of a specimen; none if it has none of that key.
const CalibratedNumber* number_of(const diagnosis::SpecimenTold& specimen, const std::string& key) {
  const auto found = std::ranges::find(specimen.constants, key, &CalibratedNumber::name);
  return found == specimen.constants.end() ? nullptr : &*found;
}

// A constant with the unit that its largest value asks for.
struct ToldKey {
  std::string name;
  Readable readable;
};

std::vector<ToldKey> keys_of(const SpecimensDiagnosis& result) {
  std::vector<const CalibratedNumber*> largest;  // of each key, in the order of their first mention
  for (const auto& specimen : result.specimens) {
    for (const auto& one : specimen.constants) {
      const auto known = std::ranges::find(largest, one.name, &CalibratedNumber::name);
      if (known == largest.end()) {
        largest.push_back(&one);
      } else if (std::abs(one.value) > std::abs((*known)->value)) {
        *known = &one;
      }
    }
  }
  std::vector<ToldKey> keys;
  for (const auto* one : largest) {
    keys.push_back({one->name, readable_constant(one->unit, one->value)});
  }
  return keys;
}

std::string cell(const SpecimensDiagnosis& result, const diagnosis::SpecimenTold& specimen,
                 const CalibratedNumber& number, double factor) {
  const bool is_odd = std::ranges::any_of(result.best.entries, [&](const OddEntry& one) {
    return one.specimen == specimen.name && one.key == number.name;
  });
  return with_deviation(factor * number.value, factor * number.std, "+-") + (is_odd ? "!" : "");
}

std::string table_of_specimens(const SpecimensDiagnosis& result) {
  std::string text = fmt::format("\n{:<38}", "specimen");
  for (const auto& one : result.specimens) text += fmt::format(" {:>15}", one.name);
  if (std::ranges::any_of(result.specimens, [](const auto& one) { return !one.group.empty(); })) {
    text += fmt::format("\n{:<38}", "group");
    for (const auto& one : result.specimens) text += fmt::format(" {:>15}", one.group);
  }
  for (const auto& [key, readable] : keys_of(result)) {
    const auto& [factor, unit] = readable;
    text += fmt::format("\n{:<38}", unit.empty() ? key : fmt::format("{} [{}]", key, unit));
    for (const auto& one : result.specimens) {
      const auto* number = number_of(one, key);
      text += fmt::format(" {:>15}", number == nullptr ? "-" : cell(result, one, *number, factor));
    }
  }
  text += fmt::format("\n{:<38}", "modes compared");
  for (const auto& one : result.specimens) text += fmt::format(" {:>15}", one.modes.size());
  text += fmt::format("\n{:<38}", "frequencies off by [%], after all");
  for (const auto& one : result.specimens) text += fmt::format(" {:>15.2f}", 100.0 * one.scatter);
  return text + "\n";
}

std::string rivals_text(const SpecimensDiagnosis& result) {
  std::string text;
  for (std::size_t i = 0; i < std::min(result.rivals.size(), kRivalsTold); ++i) {
    const auto& one = result.rivals[i];
    if (one.probability < kRivalTold) break;
    text += fmt::format("  {:.3f}  {}\n", one.probability, told_explanation(one));
  }
  return text.empty() ? "" : "instead of it, with probability:\n" + text;
}

}  // namespace

std::string entry_text(const OddEntry& one) {
  const auto [factor, unit] = readable_constant(one.unit, one.of_study);
  return fmt::format("{}: {}{}{}, written {:.{}f} ({:+.1f} %)", name_of(one),
                     with_deviation(factor * one.value, factor * one.std, " +- "),
                     unit.empty() ? "" : " ", unit, factor * one.of_study,
                     decimals_for(factor * one.std), 100.0 * one.change());
}

std::string verdict_text(const SpecimensDiagnosis& result) {
  const std::string best = told_explanation(result.best) + ".";
  switch (result.verdict) {
    case diagnosis::Verdict::no_discrepancy:
      return "The specimens differ as those of one population do: no entry is accused.";
    case diagnosis::Verdict::named:
      return "Named: " + best;
    case diagnosis::Verdict::ambiguous:
      return "Other explanations are not ruled out; the likeliest: " + best;
    case diagnosis::Verdict::partial:
      return "One entry is sure, another is not: " + best;
    case diagnosis::Verdict::unexplained:
      break;
  }
  if (!result.best.unlike.empty()) return "The experiments contradict each other: " + best;
  return "The model's errors are larger than those of a model of this design.";
}

std::string specimens_table(const SpecimensDiagnosis& result) {
  std::string text =
      fmt::format("verdict: {}\n{}\n", diagnosis::name(result.verdict), verdict_text(result));
  text += fmt::format(
      "The model's frequencies are good to {:.2g} % in all specimens alike, to {:.2g} % in each by "
      "itself.\n",
      100.0 * result.shared_error, 100.0 * result.own_error);
  text += fmt::format("every entry is right: probability {:.3f}\n", result.none);
  for (const auto& one : result.entries) {
    if (one.probability < kRivalTold) break;
    text += fmt::format("  {}: probability {:.3f}, ln evidence {:.1f}\n", name_of(one),
                        one.probability, one.log_evidence);
  }
  text += rivals_text(result) + population_text(result);
  if (!result.measure_next.empty()) text += "measure next: " + result.measure_next + "\n";
  for (const auto& note : result.notes) text += "note: " + note + "\n";
  return text + table_of_specimens(result);
}

}  // namespace chladni::show
