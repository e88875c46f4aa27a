#include "io/measured/frf_units.h"

#include <algorithm>
#include <array>

#include "base/error.h"
#include "base/quantity.h"
#include "io/scan.h"

namespace chladni::io {
namespace {

constexpr double kStandardGravity = 9.80665;  // [m/s²], the unit of accelerometer calibrations
constexpr std::array<const char*, 3> kMotion{"m", "m/s", "m/s^2"};

std::optional<double> factor(const std::string& word, const char* si) {
  try {
    return unit_factor(word, si);
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
}

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
  return bracketed ? trimmed(word.substr(1, word.size() - 2)) : word;
}

// A motion over a force in one word: "um N^-1".
std::optional<Stated> over_force(const std::string& word) {
  constexpr std::array<const char*, 3> per_newton{"m/N", "m/(s N)", "m/(s^2 N)"};
  for (std::size_t k = 0; k < per_newton.size(); ++k) {
    if (const auto si = factor(word, per_newton[k])) {
      return Stated{{kMotion[k], *si, static_cast<modal::FrfKind>(k)}, "N"};
    }
  }
  return std::nullopt;
}

// Whether it is a unit of what sensors give beside motions, or such a unit over another one.
bool is_of_other_sensors(std::string_view word) {
  constexpr const char* others[] = {"V", "A", "N", "Pa", "rad", "rad/s", "rad/s^2", "1"};
  const auto known = [&](std::string_view unit) {
    return std::ranges::any_of(
        others, [&](const char* si) { return factor(std::string(trimmed(unit)), si).has_value(); });
  };
  return known(word) || (word.rfind('/') != word.npos && known(word.substr(0, word.rfind('/'))));
}

Stated stated(const std::string& text) {
  const std::string word(bare(text));
  const auto stroke = word.rfind('/');
  if (stroke != std::string_view::npos) {
    const auto denominator = trimmed(std::string_view(word).substr(stroke + 1));
    const auto numerator = trimmed(std::string_view(word).substr(0, stroke));
    const auto force = force_unit(denominator);
    const auto motion = motion_unit(numerator);
    if (force && motion) {
      return {{motion->si, motion->factor / *force, motion->kind}, "N"};
    }
    if (motion && !motion_unit(word)) return {*motion, std::string(denominator)};
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

std::optional<MotionUnit> motion_unit(std::string_view word) {
  const std::string unit(trimmed(word));
  if (unit.empty()) return std::nullopt;
  if (unit == "g" || unit == "G" || unit == "g0" || unit == "gn") {
    return MotionUnit{kMotion[2], kStandardGravity, modal::FrfKind::accelerance};
  }
  for (std::size_t k = 0; k < kMotion.size(); ++k) {
    if (const auto si = factor(unit, kMotion[k])) {
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
  return factor(std::string(trimmed(word)), "N");
}

void bring_to_si(FrfFile& file, bool kind_known) {
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

void state_units(FrfFile& file, bool kind_known, const FrfOptions& options) {
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
