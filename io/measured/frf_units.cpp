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
constexpr std::size_t kLongestUnit = 64;  // letters; a longer word is none

std::string unknown_unit(std::string_view word) {
  return "the unit \"" + std::string(word) +
         "\" is none that is known; expected one such as \"m\", \"um\", \"mm/s\", \"m/s^2\" or "
         "\"g\", for responses also over that of the input, \"um/N\"";
}

std::string name_of(modal::FrfKind kind) {
  constexpr std::array<const char*, 3> names{"receptance", "mobility", "accelerance"};
  return names[static_cast<std::size_t>(kind)];
}

// Where the last stroke outside brackets stands; npos: there is none.
std::size_t last_stroke(std::string_view unit) {
  int depth = 0;
  for (std::size_t at = unit.size(); at-- > 0;) {
    if (unit[at] == ')' || unit[at] == ']') ++depth;
    if (unit[at] == '(' || unit[at] == '[') --depth;
    if (unit[at] == '/' && depth == 0) return at;
  }
  return std::string_view::npos;
}

/// A unit of responses, such as "g/N": the unit of the output, and the SI unit of the input.
struct Stated {
  MotionUnit output;
  std::string input_si;
};

// The two units of a motion over a force in one word, "g/N".
std::optional<std::pair<std::string, std::string>> ratio_of(std::string_view word) {
  const auto unit = bare_unit(word);
  const auto stroke = last_stroke(unit);
  if (stroke == std::string::npos || motion_unit(unit)) return std::nullopt;
  auto motion = bare_unit(std::string_view(unit).substr(0, stroke));
  auto force = bare_unit(std::string_view(unit).substr(stroke + 1));
  if (!motion_unit(motion) || !force_unit(force)) return std::nullopt;
  return std::pair(std::move(motion), std::move(force));
}

// Whether it is a unit of what sensors give beside motions, or such a unit over another one.
bool is_of_other_sensors(std::string_view word) {
  constexpr const char* others[] = {"V", "A", "N", "Pa", "rad", "rad/s", "rad/s^2", "1"};
  const auto known = [&](std::string_view unit) {
    return std::ranges::any_of(others, [&](const char* si) {
      return factor_of(std::string(trimmed(unit)), si).has_value();
    });
  };
  const auto stroke = last_stroke(word);
  return known(word) || (stroke != word.npos && known(word.substr(0, stroke)));
}

Stated stated(const std::string& text) {
  const std::string word = bare_unit(text);
  if (ratio_of(word)) return {response_per_newton(word).value(), "N"};
  const auto stroke = last_stroke(word);
  if (stroke != std::string_view::npos) {
    const auto denominator = trimmed(std::string_view(word).substr(stroke + 1));
    const auto motion = motion_unit(std::string_view(word).substr(0, stroke));
    if (motion && !motion_unit(word)) {
      require(is_of_other_sensors(denominator), unknown_unit(text));
      return {*motion, std::string(denominator)};
    }
  }
  if (const auto motion = motion_unit(word)) return {*motion, ""};
  if (const auto motion = unit_over_newton(word)) return {*motion, "N"};
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

namespace {

enum class Brackets { odd, within, around };

// Whether the brackets of a unit belong together, and whether one pair is around the whole of it,
// unlike "(m)/(N)".
Brackets brackets_of(std::string_view unit) {
  std::string open;  // brackets that are not closed yet
  bool is_around = unit.size() > 2;
  for (std::size_t at = 0; at < unit.size(); ++at) {
    if (unit[at] == '(' || unit[at] == '[') open += unit[at];
    if (unit[at] == ')' || unit[at] == ']') {
      if (open.empty() || (open.back() == '(') != (unit[at] == ')')) return Brackets::odd;
      open.pop_back();
    }
    if (open.empty() && at + 1 < unit.size()) is_around = false;
  }
  if (!open.empty()) return Brackets::odd;
  return is_around ? Brackets::around : Brackets::within;
}

}  // namespace

std::string bare_unit(std::string_view word) {
  std::string unit(trimmed(word));
  if (unit.size() > kLongestUnit) return unit;
  for (auto at = unit.find("**"); at != unit.npos; at = unit.find("**")) unit.replace(at, 2, "^");
  auto brackets = brackets_of(unit);
  if (brackets == Brackets::odd) return unit;
  std::ranges::replace(unit, '[', '(');
  std::ranges::replace(unit, ']', ')');
  for (; brackets == Brackets::around; brackets = brackets_of(unit)) {
    unit = std::string(trimmed(std::string_view(unit).substr(1, unit.size() - 2)));
  }
  return unit;
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

std::string si_unit_of(modal::FrfKind kind) { return kMotion[static_cast<std::size_t>(kind)]; }

MotionUnit stated_unit(std::string_view word) {
  if (word == kEachInSi) return {};
  const auto unit = bare_unit(word);
  if (auto motion = motion_unit(unit)) return *motion;
  require(unit.empty() || is_of_other_sensors(unit), unknown_unit(word));
  return {unit, 1.0, std::nullopt};
}

std::optional<MotionUnit> unit_over_newton(const std::string& word) {
  constexpr std::array<const char*, 3> per_newton{"m/N", "m/(s N)", "m/(s^2 N)"};
  for (std::size_t k = 0; k < per_newton.size(); ++k) {
    if (const auto si = factor_of(bare_unit(word), per_newton[k])) {
      return MotionUnit{kMotion[k], *si, static_cast<modal::FrfKind>(k)};
    }
  }
  return std::nullopt;
}

std::optional<double> force_unit(std::string_view word) {
  const std::string unit = bare_unit(word);
  if (unit.empty()) return std::nullopt;
  if (const auto newtons = factor_of(unit, "N")) return newtons;
  static const std::map<std::string, const char*, std::less<>> spelled{
      {"LBF", "lbf"}, {"LB", "lbf"},  {"LBS", "lbf"},  {"KN", "kN"},
      {"KGF", "kgf"}, {"DYN", "dyn"}, {"NEWTON", "N"}, {"NEWTONS", "N"}};
  const auto found = spelled.find(upper(unit));
  return found == spelled.end() ? std::nullopt : factor_of(found->second, "N");
}

std::optional<MotionUnit> response_per_newton(const std::string& word) {
  const auto ratio = ratio_of(word);
  if (!ratio) return unit_over_newton(word);
  auto motion = motion_unit(ratio->first).value();
  motion.factor /= force_unit(ratio->second).value();
  return motion;
}

bool is_response_unit(const std::string& word) { return response_per_newton(word).has_value(); }

bool stands_in(std::string_view unit, std::string_view word) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  for (auto at = word.find(unit); at != word.npos && !unit.empty(); at = word.find(unit, at + 1)) {
    const auto end = at + unit.size();
    const bool is_begin = at == 0 || !is_letter(word[at - 1]);
    if (is_begin && (end == word.size() || !is_letter(word[end]))) return true;
  }
  return false;
}

bool is_measured_unit(const std::string& word) {
  const bool has_letters = std::ranges::any_of(word, [](char c) { return c < '0' || c > '9'; });
  return has_letters && (motion_unit(word) || force_unit(word) || is_response_unit(word) ||
                         is_of_other_sensors(word));
}

namespace {

// Gives the inputs the unit of force that stands in that of an output.
void state_force(modal::FrfSet& set, const modal::MeasuredChannel& output,
                 const std::string& force) {
  for (auto& input : set.inputs) {
    if (input.unit.empty()) input.unit = force;
    require(force_unit(input.unit) == force_unit(force),
            "the unit " + shown(output.unit) + " of " + output.name + " is over another one than " +
                shown(input.unit) + ", that of the input " + input.name);
  }
}

// A motion over a motion, "g/g", is none over a force.
void refuse_transmissibility(const modal::MeasuredChannel& output) {
  const auto unit = bare_unit(output.unit);
  const auto stroke = last_stroke(unit);
  if (stroke == std::string::npos || motion_unit(unit) || is_response_unit(unit)) return;
  const auto of = [&](std::size_t from, std::size_t count) {
    return motion_unit(bare_unit(std::string_view(unit).substr(from, count))).has_value();
  };
  require(!of(0, stroke) || !of(stroke + 1, unit.npos),
          "the unit " + shown(output.unit) + " of " + output.name +
              " is that of a transmissibility; expected responses to forces");
}

// The force in a word such as "um kN^-1": the unit of an input that stands in it, else "N".
std::string force_in(const std::string& word, const std::vector<modal::MeasuredChannel>& inputs) {
  for (const auto& input : inputs) {
    if (force_unit(input.unit) && stands_in(bare_unit(input.unit), word)) return input.unit;
  }
  return "N";
}

// "um/N" of an output becomes "um", and "N" the unit of the inputs; so does "um N^-1".
void split_ratios(modal::FrfSet& set) {
  for (std::size_t i = 0; i < set.outputs.size(); ++i) {
    auto& output = set.outputs[i];
    refuse_transmissibility(output);
    if (const auto ratio = ratio_of(output.unit)) {
      state_force(set, output, ratio->second);
      output.unit = ratio->first;
    } else if (const auto motion = unit_over_newton(output.unit)) {
      const auto force = force_in(output.unit, set.inputs);
      state_force(set, output, force);
      output.unit = motion->si;
      scale(set, static_cast<Eigen::Index>(i), motion->factor * force_unit(force).value_or(1.0));
    }
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
    if (kind_known || options.kind) output.unit = si_unit_of(output.kind);
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

void note_unknown_output(const modal::MeasuredChannel& output, std::vector<std::string>& notes) {
  const auto& unit = output.unit;
  if (unit.empty() || motion_unit(unit) || is_of_other_sensors(unit)) return;
  notes.push_back("the unit " + shown(unit) + " of " + output.name +
                  " is not known: values are as they stand");
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
