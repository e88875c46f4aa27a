#include "io/measured/frf_units.h"

#include <algorithm>
#include <array>
#include <functional>
#include <map>

#include "base/error.h"
#include "base/quantity.h"
#include "io/scan.h"

namespace chladni::io {
namespace {

constexpr double kStandardGravity = 9.80665;  // [m/s²], the unit of accelerometer calibrations
constexpr std::array<const char*, 3> kMotion{"m", "m/s", "m/s^2"};

std::string unknown_unit(std::string_view word) {
  return "the unit \"" + std::string(word) +
         "\" is none that is known; expected one such as \"m\", \"um\", \"mm/s\", \"m/s^2\" or "
         "\"g\", for responses also over that of the input, \"um/N\"";
}

std::string name_of(modal::FrfKind kind) {
  constexpr std::array<const char*, 3> names{"receptance", "mobility", "accelerance"};
  return names[static_cast<std::size_t>(kind)];
}

/// A unit of responses, such as "g/N": the unit of the output, and the SI unit of the input.
struct Stated {
  MotionUnit output;
  std::string input_si;
};

// Without the brackets around it: "[mm]", "(g)".
std::string_view bare(std::string_view word) {
  word = trimmed(word);
  const bool bracketed = word.size() > 2 && ((word.front() == '[' && word.back() == ']') ||
                                             (word.front() == '(' && word.back() == ')'));
  const bool is_one = bracketed && word.find(word.back()) == word.size() - 1;  // not "(m)/(N)"
  return is_one ? trimmed(word.substr(1, word.size() - 2)) : word;
}

// A motion over a force in one word: "um N^-1".
std::optional<Stated> over_force(const std::string& word) {
  constexpr std::array<const char*, 3> per_newton{"m/N", "m/(s N)", "m/(s^2 N)"};
  for (std::size_t k = 0; k < per_newton.size(); ++k) {
    if (const auto si = factor_of(word, per_newton[k])) {
      return Stated{{kMotion[k], *si, static_cast<modal::FrfKind>(k)}, "N"};
    }
  }
  return std::nullopt;
}

// The two units of a motion over a force in one word, "g/N".
std::optional<std::pair<std::string, std::string>> ratio_of(std::string_view word) {
  const auto unit = bare(word);
  const auto stroke = unit.rfind('/');
  if (stroke == std::string_view::npos || motion_unit(unit)) return std::nullopt;
  const auto motion = bare(unit.substr(0, stroke)), force = bare(unit.substr(stroke + 1));
  if (!motion_unit(motion) || !force_unit(force)) return std::nullopt;
  return std::pair(std::string(motion), std::string(force));
}

// Whether it is a unit of what sensors give beside motions, or such a unit over another one.
bool is_of_other_sensors(std::string_view word) {
  constexpr const char* others[] = {"V", "A", "N", "Pa", "rad", "rad/s", "rad/s^2", "1"};
  const auto known = [&](std::string_view unit) {
    return std::ranges::any_of(others, [&](const char* si) {
      return factor_of(std::string(trimmed(unit)), si).has_value();
    });
  };
  return known(word) || (word.rfind('/') != word.npos && known(word.substr(0, word.rfind('/'))));
}

Stated stated(const std::string& text) {
  const std::string word(bare(text));
  if (const auto ratio = ratio_of(word)) {
    const auto motion = motion_unit(ratio->first).value();
    return {{motion.si, motion.factor / force_unit(ratio->second).value(), motion.kind}, "N"};
  }
  const auto stroke = word.rfind('/');
  if (stroke != std::string_view::npos) {
    const auto denominator = trimmed(std::string_view(word).substr(stroke + 1));
    const auto motion = motion_unit(std::string_view(word).substr(0, stroke));
    if (motion && !motion_unit(word)) {
      require(is_of_other_sensors(denominator), unknown_unit(text));
      return {*motion, std::string(denominator)};
    }
  }
  if (const auto motion = motion_unit(word)) return {*motion, ""};
  if (const auto motion = over_force(word)) return *motion;
  require(is_of_other_sensors(word), unknown_unit(text));
  return {{word, 1.0, std::nullopt}, ""};
}

void scale(modal::FrfSet& set, Eigen::Index output, double by) {
  if (by == 1.0) return;
  for (auto& line : set.value) line.row(output) *= by;
  for (auto& line : set.variance) line.row(output) *= by * by;
  for (auto& line : set.noise_variance) line.row(output) *= by * by;
}

}  // namespace

std::optional<double> factor_of(const std::string& unit, const std::string& si) {
  try {
    return unit_factor(unit, si);
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
}

std::optional<MotionUnit> motion_unit(std::string_view word) {
  const std::string unit(trimmed(word));
  if (unit.empty()) return std::nullopt;
  static const std::map<std::string, double, std::less<>> gravities{
      {"g", 1.0},   {"G", 1.0},   {"g0", 1.0},  {"gn", 1.0},
      {"mg", 1e-3}, {"mG", 1e-3}, {"ug", 1e-6}, {"µg", 1e-6}};
  if (const auto found = gravities.find(unit); found != gravities.end()) {
    return MotionUnit{kMotion[2], found->second * kStandardGravity, modal::FrfKind::accelerance};
  }
  for (std::size_t k = 0; k < kMotion.size(); ++k) {
    if (const auto si = factor_of(unit, kMotion[k])) {
      return MotionUnit{kMotion[k], *si, static_cast<modal::FrfKind>(k)};
    }
  }
  return std::nullopt;
}

MotionUnit stated_unit(std::string_view word) {
  if (word == kEachInSi) return {};
  const auto unit = bare(word);
  if (auto motion = motion_unit(unit)) return *motion;
  require(unit.empty() || is_of_other_sensors(unit), unknown_unit(word));
  return {std::string(unit), 1.0, std::nullopt};
}

std::optional<double> force_unit(std::string_view word) {
  const std::string unit(bare(word));
  if (unit.empty()) return std::nullopt;
  if (const auto newtons = factor_of(unit, "N")) return newtons;
  static const std::map<std::string, const char*, std::less<>> spelled{
      {"LBF", "lbf"}, {"LB", "lbf"},  {"LBS", "lbf"},  {"KN", "kN"},
      {"KGF", "kgf"}, {"DYN", "dyn"}, {"NEWTON", "N"}, {"NEWTONS", "N"}};
  const auto found = spelled.find(upper(unit));
  return found == spelled.end() ? std::nullopt : factor_of(found->second, "N");
}

bool is_measured_unit(const std::string& word) {
  const bool has_letters = std::ranges::any_of(word, [](char c) { return c < '0' || c > '9'; });
  return has_letters && (motion_unit(word) || force_unit(word) || ratio_of(word) ||
                         over_force(word) || is_of_other_sensors(word));
}

namespace {

// "um/N" of an output becomes "um", and "N" the unit of the inputs.
void split_ratios(modal::FrfSet& set) {
  for (auto& output : set.outputs) {
    const auto ratio = ratio_of(output.unit);
    if (!ratio) continue;
    const auto newtons = force_unit(ratio->second);
    for (auto& input : set.inputs) {
      if (input.unit.empty()) input.unit = ratio->second;
      require(force_unit(input.unit) == newtons, "the unit " + shown(output.unit) + " of " +
                                                     output.name + " is over another one than " +
                                                     shown(input.unit) + ", that of the input " +
                                                     input.name);
    }
    output.unit = ratio->first;
  }
}

}  // namespace

void bring_to_si(FrfFile& file, bool kind_known) {
  split_ratios(file.set);
  for (std::size_t i = 0; i < file.set.outputs.size(); ++i) {
    auto& output = file.set.outputs[i];
    const auto unit = motion_unit(output.unit);
    if (!unit) continue;
    require(!kind_known || output.kind == unit->kind,
            output.name + " is said to be of a " + name_of(output.kind) + ", its unit \"" +
                output.unit + "\" is of a " + name_of(unit->kind.value_or(output.kind)));
    output.kind = unit->kind.value_or(output.kind);
    output.unit = unit->si;
    scale(file.set, static_cast<Eigen::Index>(i), unit->factor);
  }
  for (std::size_t j = 0; j < file.set.inputs.size(); ++j) {
    auto& input = file.set.inputs[j];
    const auto force = force_unit(input.unit);
    if (!force) continue;
    input.unit = "N";
    if (*force == 1.0) continue;
    const auto column = static_cast<Eigen::Index>(j);
    for (auto& line : file.set.value) line.col(column) /= *force;
    for (auto& line : file.set.variance) line.col(column) /= *force * *force;
    for (auto& line : file.set.noise_variance) line.col(column) /= *force * *force;
  }
}

namespace {

// Gives the stated unit to an output without a unit.
void state_unit(FrfFile& file, std::size_t i, const Stated& unit, bool kind_known,
                const FrfOptions& options) {
  auto& output = file.set.outputs[i];
  const auto known = options.kind ? motion_unit(output.unit) : std::nullopt;
  require(!known || known->kind == options.kind, output.name + " is in " + output.unit +
                                                     " in the file, the unit of no " +
                                                     name_of(options.kind.value_or(output.kind)));
  if (options.kind) output.kind = *options.kind;
  if (!output.unit.empty()) return;
  if (options.unit == kEachInSi) {
    if (kind_known || options.kind) output.unit = kMotion[static_cast<std::size_t>(output.kind)];
    return;
  }
  const auto kind = options.kind ? options.kind : unit.output.kind;
  require(!kind_known || options.kind || !kind || *kind == output.kind,
          "the unit \"" + options.unit + "\" is of a " + name_of(kind.value_or(output.kind)) +
              ", the file says that " + output.name + " is of a " + name_of(output.kind));
  output.kind = kind.value_or(output.kind);
  output.unit = unit.output.si;
  scale(file.set, static_cast<Eigen::Index>(i), unit.output.factor);
}

}  // namespace

void note_unknown(const modal::MeasuredChannel& input, std::vector<std::string>& notes) {
  const bool is_known = input.unit.empty() || force_unit(input.unit) ||
                        factor_of(input.unit, "N m") ||
                        (is_of_other_sensors(input.unit) && !factor_of(input.unit, "1"));
  if (is_known) return;
  notes.push_back("the unit " + shown(input.unit) + " of the input " + input.name +
                  " is not known, or none of an input: values are as they stand");
}

void note_unused(const std::string& unit, const std::vector<modal::MeasuredChannel>& outputs,
                 std::vector<std::string>& notes) {
  const auto is_missing = [](const auto& output) { return output.unit.empty(); };
  const auto is_same = [&](const auto& output) { return output.unit == unit; };
  if (unit.empty() || unit == kEachInSi || outputs.empty()) return;
  if (std::ranges::any_of(outputs, is_missing) || std::ranges::all_of(outputs, is_same)) return;
  notes.push_back("the file states the units: the unit \"" + unit + "\" is not used");
}

void state_units(FrfFile& file, bool kind_known, const FrfOptions& options) {
  note_unused(options.unit, file.set.outputs, file.notes);
  const bool each_in_si = options.unit == kEachInSi;
  const Stated unit = options.unit.empty() || each_in_si ? Stated{} : stated(options.unit);
  const bool contradict = options.kind && unit.output.kind && *options.kind != *unit.output.kind;
  require(!contradict,
          "the unit \"" + options.unit + "\" is of another kind than the responses are said to be");
  for (std::size_t i = 0; i < file.set.outputs.size(); ++i) {
    state_unit(file, i, unit, kind_known, options);
  }
  for (auto& input : file.set.inputs) {
    if (input.unit.empty()) input.unit = unit.input_si;
  }
  for (const auto& input : file.set.inputs) {
    const auto motion = motion_unit(input.unit);
    require(!motion || motion->kind == modal::FrfKind::receptance,
            "the input " + input.name + " is in \"" + input.unit +
                "\", a unit of motions; expected responses to forces, no transmissibilities");
    note_unknown(input, file.notes);
  }
  const auto& outputs = file.set.outputs;
  const auto nameless = std::find_if(outputs.begin(), outputs.end(),
                                     [](const auto& output) { return output.unit.empty(); });
  if (nameless == outputs.end() || each_in_si) return;
  const bool assumed = !kind_known && !options.kind;
  file.notes.push_back("the unit of " + nameless->name +
                       " is not stated: values are as they stand" +
                       (assumed ? ", taken as " + name_of(nameless->kind) : "") +
                       R"(; say it as unit = "m", "m/s^2" or "g")");
}

}  // namespace chladni::io
