#include "steps/diagnosis/by_modes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>

#include "base/error.h"
#include "diagnosis/constants.h"
#include "diagnosis/diagnosed_modes.h"
#include "stage/diagnosis_structure.h"
#include "steps/measured_modes.h"

namespace chladni::steps {
namespace {

using diagnosis::kConstants;
using diagnosis::Verdict;

constexpr double kOneAxis = 1.0 - 1e-9;  // cosine of axes that lie along each other

constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kToldLevels = {
    {{"frequency", "frequencies"}, {"shape", "shapes"}, {"damping", "damping ratios"}}};

// A calibrated constant in the form that an extension of a study takes.
diagnosis::Cause as_cause(const diagnosis::CalibratedNumber& constant) {
  diagnosis::Cause cause;
  cause.effect = constant.effect;
  const double std = constant.std / constant.of_study;
  if (constant.effect == "modal_damping") {
    cause.parameters = {{"factor", "1", constant.value / constant.of_study, std}};
  } else {
    cause.parameters = {{"relative", "1", constant.change(), std}};
  }
  cause.probability = 1.0;
  return cause;
}

std::string reason_in_words(const diagnosis::Diagnosis& by_modes) {
  std::string levels;
  for (const auto& [what, level] : told_levels(by_modes.levels_after)) {
    levels += (levels.empty() ? ": " : ", ") + what + " " + level;
  }
  return "the responses are not explained to the noise; with the model's errors learned from "
         "their modes" +
         levels;
}

// The modes identified from the responses; none: there are none.
std::optional<diagnosis::MeasuredModes> modes_of_fit(const Diagnosed& one, bool scaled) {
  if (!one.identified) return std::nullopt;
  const auto& lines = one.seen.frequency_hz;
  auto modes =
      diagnosis::measured_modes(*one.identified, modal::names_of(one.seen.outputs),
                                modal::names_of(one.seen.inputs), lines(0), lines.tail(1)(0));
  modes.scaled = scaled;
  if (modes.count() == 0) return std::nullopt;
  return modes;
}

// The causes that the modes name become the answer.
void answer_by_modes(Diagnosed& one) {
  const auto& by_modes = *one.by_modes;
  auto& result = one.result;
  if (!result.best.causes.empty()) {  // what is left beside causes that are no longer told
    result.map = by_modes.map;
    result.after = result.before;
  }
  result.verdict = by_modes.verdict;
  result.best = by_modes.best;
  result.best.excess =
      std::numeric_limits<double>::quiet_NaN();  // modes tell no misfit of responses
  result.rivals = by_modes.rivals;
  result.superclass = by_modes.superclass;
  result.measure_next = by_modes.measure_next;
  result.proposals = by_modes.proposals;
  result.breaches = by_modes.breaches;
  result.cross_validation.reset();  // that of other causes
  result.modes = by_modes.modes;
  result.constants = by_modes.constants;
  result.constants_in_pairs = by_modes.constants_in_pairs;
  result.notes = result.data_notes;
  for (const auto& note : by_modes.notes) {
    if (std::ranges::find(result.notes, note) == result.notes.end()) result.notes.push_back(note);
  }
  result.notes.push_back(reason_in_words(by_modes));
}

// Whether the shapes of modes say what frequencies alone cannot: which error is the model's, and
// which follows a cause.
bool shapes_tell(const Diagnosed& one) {
  return one.seen.output_count() + one.seen.input_count() >= kConstants.channels_that_tell;
}

// No cause beside something unknown is likelier than not.
void believe_none(diagnosis::Diagnosis& result) {
  result.best.probability = std::min(result.best.probability, kConstants.extended_cause);
  for (auto& cause : result.best.causes)
    cause.probability = std::min(cause.probability, kConstants.extended_cause);
}

// Whether the errors of a model in which nothing is wrong are those of real models.
bool is_of_real_models(const diagnosis::Diagnosis& by_modes) {
  if (by_modes.verdict != Verdict::no_discrepancy) return true;
  const auto at_most = [&](std::string_view name, double largest) {
    const auto level = std::ranges::find(by_modes.levels_after, name, &diagnosis::ErrorLevel::of);
    return level == by_modes.levels_after.end() || level->value <= largest;
  };
  return at_most("frequency", kConstants.real_frequency) &&
         at_most("shape", kConstants.real_shape) && at_most("smooth_shape", kConstants.real_shape);
}

// Constants of the study as modes of the responses have them, without a cause.
std::vector<diagnosis::CalibratedNumber> calibrated_by(const diagnosis::MeasuredModes& modes,
                                                       const Diagnosed& one,
                                                       const diagnosis::DiagnosisOptions& options,
                                                       stage::Work& work) {
  auto alone = options;
  alone.most_causes = 0;
  return work.timed("constants by the modes", [&] {
    const auto at_values = [&](const std::exception& e) {
      work.warn(std::string("the fits of the constants start at the study's values: ") + e.what());
      return std::vector<diagnosis::CalibratedNumber>{};
    };
    try {
      return diagnosis::diagnosed(one.structure, modes, alone).constants;
    } catch (const InvalidInput& e) {
      return at_values(e);
    } catch (const NumericalFailure& e) {
      return at_values(e);
    }
  });
}

}  // namespace

std::vector<std::pair<std::string, std::string>> told_levels(
    const std::vector<diagnosis::ErrorLevel>& levels) {
  std::vector<std::pair<std::string, std::string>> told;
  for (const auto& [name, what] : kToldLevels) {
    const auto level = std::ranges::find(levels, name, &diagnosis::ErrorLevel::of);
    if (level == levels.end() || level->determined < kConstants.told_errors) continue;
    told.emplace_back(what, fmt::format("{:.2g} %", 100.0 * level->value));
  }
  return told;
}

diagnosis::DiagnosisOptions options_of(const study::DiagnosisPlan& plan, stage::Work& work) {
  diagnosis::DiagnosisOptions options;
  options.tolerances = plan.tolerances;
  options.levels = plan.levels == "known" ? diagnosis::Levels::known : diagnosis::Levels::learned;
  options.lines = plan.lines;
  options.most_causes = plan.most_causes;
  options.least_evidence = plan.least_evidence;
  options.rival_within = plan.rival_within;
  options.only = plan.effects;
  options.costs = plan.costs;
  options.progress = work.progress();
  return options;
}

std::vector<diagnosis::CalibratedConstant> constants_of(const study::Study& study,
                                                        const diagnosis::Surface& chart) {
  const bool along =
      chart.axis_u.cwiseAbs().x() > kOneAxis && chart.axis_v.cwiseAbs().y() > kOneAxis;
  const bool crossed =
      chart.axis_u.cwiseAbs().y() > kOneAxis && chart.axis_v.cwiseAbs().x() > kOneAxis;
  auto constants = study.constants;
  std::erase_if(constants, [&](const diagnosis::CalibratedConstant& one) {
    return one.effect.find("stiffness") != std::string::npos && !along && !crossed;
  });
  for (auto& one : constants) {
    if (!crossed) break;
    if (one.effect == "stiffness_along_u") {
      one.effect = "stiffness_along_v";
    } else if (one.effect == "stiffness_along_v") {
      one.effect = "stiffness_along_u";
    }
  }
  return constants;
}

diagnosis::FitStart start_by_modes(const Diagnosed& one, bool scaled,
                                   const diagnosis::DiagnosisOptions& options, stage::Work& work) {
  diagnosis::FitStart start{{}, modes_of_fit(one, scaled)};
  if (options.constants.empty()) return start;
  if (start.modes) {
    start.constants = calibrated_by(*start.modes, one, options, work);
  } else {
    work.note("no modes were identified: the fits of the constants start at the study's values");
  }
  return start;
}

bool has_other_modes(const Diagnosed& one, const diagnosis::DiagnosisOptions& options) {
  if (!shapes_tell(one)) return false;
  Eigen::ArrayXd off(std::ssize(one.modes_compared));
  Eigen::Index count = 0;
  for (const auto& mode : one.modes_compared) {
    const double by = std::log(mode.measured_hz / mode.before_hz);
    if (std::isfinite(by)) off(count++) = by;
  }
  const auto all = static_cast<double>(off.size());
  if (off.size() > 1 && static_cast<double>(count) < kConstants.few_partners * all) return true;
  if (count < 2) return false;
  const auto known = off.head(count);
  const double scatter = std::sqrt((known - known.mean()).square().mean());
  return scatter > kConstants.scattered_modes * options.tolerances.frequency;
}

bool is_open(const Diagnosed& one) {
  return one.result.verdict == Verdict::unexplained || one.result.verdict == Verdict::partial;
}

bool is_less_good(const Diagnosed& one, const diagnosis::DiagnosisOptions& options) {
  return one.by_modes && shapes_tell(one) &&
         diagnosis::are_beyond(options.tolerances, one.by_modes->levels_after);
}

void diagnose_modes(Diagnosed& one, const std::optional<diagnosis::MeasuredModes>& modes,
                    const diagnosis::DiagnosisOptions& options, stage::Work& work) {
  if (options.levels == diagnosis::Levels::known || !modes) return;
  one.by_modes = work.timed("diagnosis of the modes",
                            [&] { return diagnosis::diagnosed(one.structure, *modes, options); });
}

diagnosis::DiagnosisOptions beside_modes(const Diagnosed& one,
                                         diagnosis::DiagnosisOptions options) {
  options.is_look = is_less_good(one, options);
  return options;
}

diagnosis::DiagnosisOptions beside_errors(const Diagnosed& one,
                                          diagnosis::DiagnosisOptions options) {
  if (is_of_modes(one) && is_less_good(one, options)) {
    options.tolerances = diagnosis::with_levels(options.tolerances, one.result.levels_after);
  }
  return options;
}

bool is_promising(const Diagnosed& one) {
  if (!is_open(one)) return true;
  return !one.result.best.causes.empty() &&
         one.result.best.excess < kConstants.promising * one.result.excess_before;
}

void take_answer_of_modes(Diagnosed& one, const diagnosis::DiagnosisOptions& options) {
  if (!one.by_modes || !is_open(one)) return;
  const auto& by_modes = *one.by_modes;
  const bool nothing_else = one.result.verdict == Verdict::unexplained;
  const bool alone = nothing_else && is_less_good(one, options);
  const bool names = by_modes.verdict == Verdict::named ||
                     (by_modes.verdict == Verdict::ambiguous && nothing_else);
  one.result.levels_before = by_modes.levels_before;
  one.result.levels_after = alone || names ? by_modes.levels_after : by_modes.levels_before;
  if (one.result.measure_next.empty()) {
    one.result.measure_next = by_modes.measure_next;
    one.result.proposals = by_modes.proposals;
  }
  if (alone || names) {
    answer_by_modes(one);
    if (!is_of_real_models(by_modes)) one.result.verdict = Verdict::unexplained;
    if (one.result.verdict == Verdict::unexplained) believe_none(one.result);
  } else if (by_modes.verdict == Verdict::no_discrepancy) {
    one.result.notes.push_back(reason_in_words(by_modes) + ", nothing contradicts the model");
  }
}

void believe_what_pays(Diagnosed& one) {
  if (!is_of_modes(one) || one.gain.pays.value_or(true)) return;
  auto& result = one.result;
  result.verdict = Verdict::unexplained;
  result.levels_after = result.levels_before;
  believe_none(result);
  result.notes.emplace_back(
      "the causes that the modes name predict the responses no better: they are not believed");
}

std::vector<diagnosis::Cause> constants_as_causes(const diagnosis::Diagnosis& result) {
  std::vector<diagnosis::Cause> causes;
  for (const auto& constant : result.constants) {
    if (constant.determined) causes.push_back(as_cause(constant));
  }
  return causes;
}

std::vector<diagnosis::Cause> causes_to_extend(const Diagnosed& one) {
  if (one.result.verdict == Verdict::unexplained) return {};
  auto causes = one.result.best.causes;
  if (is_of_modes(one)) {
    std::erase_if(causes, [](const diagnosis::Cause& cause) {
      return cause.probability < kConstants.extended_cause;
    });
  }
  auto all = constants_as_causes(one.result);
  all.insert(all.end(), causes.begin(), causes.end());
  return all;
}

ModesOfFiles modes_of_files(const study::Study& study, stage::Work& work) {
  ModesOfFiles files{measured_modes(study, work), {}};
  files.reference = reference_modes(study, files.modes, work);
  return files;
}

void drop_mac_without_shapes(Diagnosed& one) {
  if (!one.modes->outputs.empty() || !one.modes->inputs.empty()) return;
  for (auto& mode : one.result.modes) {
    mode.mac_before = mode.mac_after = std::numeric_limits<double>::quiet_NaN();
  }
}

void retell_modes(const study::Study& extended, const stage::Solution& after,
                  const diagnosis::DiagnosisOptions& options, Diagnosed& one) {
  auto alone = options;
  alone.most_causes = 0;
  const double high_hz = one.modes->frequency_hz.tail(1)(0);
  const auto solved =
      diagnosis::diagnosed(stage::structure_of(extended, after, high_hz), *one.modes, alone);
  const bool in_channels =
      std::ranges::any_of(one.result.best.causes,
                          [](const diagnosis::Cause& cause) { return !cause.channels.empty(); });
  for (std::size_t k = 0; k < one.result.modes.size(); ++k) {
    one.result.modes[k].after_hz = solved.modes[k].before_hz;
    if (!in_channels) one.result.modes[k].mac_after = solved.modes[k].mac_before;
  }
  drop_mac_without_shapes(one);
}

}  // namespace chladni::steps
