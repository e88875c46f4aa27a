#include "steps/diagnosis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <numbers>

#include "base/error.h"
#include "diagnosis/calibrated_responses.h"
#include "diagnosis/diagnosed_modes.h"
#include "diagnosis/hypothesis.h"
#include "diagnosis/observed.h"
#include "host/atomic_file.h"
#include "stage/channel_paths.h"
#include "stage/diagnosis_faces.h"
#include "stage/diagnosis_structure.h"
#include "steps/diagnosis/beside_measured.h"
#include "steps/diagnosis/by_modes.h"
#include "steps/diagnosis/errors_told.h"
#include "steps/diagnosis/responses_in_band.h"
#include "steps/measured_modes.h"

namespace chladni::steps {
namespace {

using Eigen::Index;

// Folders from which the files of the extended study may be read.
std::vector<std::filesystem::path> allowed_for(const study::Study& study, const stage::Work& work) {
  auto allowed = work.choices().allowed;
  allowed.push_back(std::filesystem::absolute(study.file).parent_path());
  return allowed;
}

// The channels of the study that were diagnosed, and the surface on which causes were sought.
DiagnosedOn diagnosed_on(const Diagnosed& one, const stage::DiagnosedFaces& faces) {
  const auto among = [](std::vector<std::string> names, const std::vector<std::string>& all) {
    std::erase_if(
        names, [&](const std::string& name) { return std::ranges::find(all, name) == all.end(); });
    return names;
  };
  const auto& outputs = one.structure.outputs.names;
  const auto& inputs = one.structure.inputs.names;
  DiagnosedOn on;
  on.sensors = among(one.modes ? one.modes->outputs : modal::names_of(one.seen.outputs), outputs);
  on.actuators = among(one.modes ? one.modes->inputs : modal::names_of(one.seen.inputs), inputs);
  const auto& body = one.before.model.body;
  const auto face = std::make_shared<stage::UpperFace>(faces.chart, body,
                                                       Eigen::MatrixXd(3 * body.node_count(), 0),
                                                       stage::ModesAbove{}, faces.chosen);
  on.height = [face](const Eigen::Vector2d& place) { return face->height(place); };
  return on;
}

// Writes the extended study, and solves it in full if a cause changed it.
void extend(const study::Study& study, double band_hz, const SolveStudy& solve, Diagnosed& one,
            stage::Work& work) {
  const auto causes = causes_to_extend(one);
  const auto allowed = allowed_for(study, work);
  const auto& body = one.before.model.body;
  const auto faces = stage::diagnosed_faces(study, body);
  const bool fits = stage::has_the_axes_of_variations(faces.chart, body);
  one.extended = extended_study(study.text, study.file, one.structure.surface, causes,
                                work.choices().folder, allowed, fits, diagnosed_on(one, faces));
  if (one.extended->unexpressed.size() == causes.size()) return;
  if (one.reference) return;  // solved again, it would be off by what the study is off by
  const auto part = work.part("extended: ");
  const study::Study extended = stage::with_modes_for_diagnosis(
      study::parse_study(one.extended->text, work.choices().folder / "extended.toml", allowed));
  one.after = solve(extended, work);
  if (one.modes) {
    retell_modes(extended, *one.after, options_of(plan_of(extended), work), one);
    return;
  }
  const auto structure = stage::structure_of(extended, *one.after, band_hz);
  one.predictions.extended = predicted(extended, structure, study, one.measured.all);
  if (one.identified) {
    one.modes_compared = modes_of_responses(one, *one.identified, &structure);
  }
}

// A mass at the place of each channel.
void hang_on_each(const diagnosis::Cause& masses, const diagnosis::ChannelSide& channels,
                  std::vector<diagnosis::Cause>& causes) {
  for (const auto place : channels.places.rowwise()) {
    diagnosis::Cause one;
    one.effect = "point_mass";
    one.parameters = masses.parameters;
    one.parameters.push_back({"u", "m", place(0)});
    one.parameters.push_back({"v", "m", place(1)});
    causes.push_back(std::move(one));
  }
}

// The causes of the channels of the fit, on all channels. If a wrong unit or quantity applies to
// all sensors of the fit, it also applies to those held out. Masses hang where the fit had them.
std::vector<diagnosis::Cause> of_all_channels(const std::vector<diagnosis::Cause>& causes,
                                              const diagnosis::Structure& seen,
                                              const diagnosis::Structure& all) {
  std::vector<diagnosis::Cause> result;
  for (const auto& cause : causes) {
    if (cause.effect == "sensor_masses") {
      hang_on_each(cause, seen.outputs, result);
    } else if (cause.effect == "actuator_masses") {
      hang_on_each(cause, seen.inputs, result);
    } else {
      result.push_back(cause);
      const bool is_of_all = !cause.option.empty() && cause.channels == seen.outputs.names;
      if (is_of_all) result.back().channels = all.outputs.names;
    }
  }
  return result;
}

// Prediction of the reduced model with all causes and constants. The channels of the fit use the
// structure as it was fitted. The other channels use the structure with all its channels and the
// same causes.
std::vector<Eigen::MatrixXcd> fitted_model(const Diagnosed& one) {
  const auto& set = one.measured.all;
  const auto& constants = one.result.constants;
  const auto& causes = one.result.best.causes;
  const auto own = diagnosis::seen(one.structure, one.seen, HUGE_VAL).structure;
  const auto seen = diagnosis::predicted(own, constants, causes, set.frequency_hz);
  const auto all = diagnosis::predicted(
      one.structure, constants, of_all_channels(causes, own, one.structure), set.frequency_hz);
  const auto rows = places(set.outputs, one.structure.outputs.names);
  const auto cols = places(set.inputs, one.structure.inputs.names);
  const auto own_rows = places(one.seen.outputs, own.outputs.names);
  const auto own_cols = places(one.seen.inputs, own.inputs.names);
  std::vector<Eigen::MatrixXcd> value;
  for (std::size_t k = 0; k < all.size(); ++k) {
    value.emplace_back(all[k](rows, cols));
    value.back()(one.measured.outputs, one.measured.inputs) = seen[k](own_rows, own_cols);
  }
  return value;
}

// Runs a step that may fail. A failure is reported and noted, and the diagnosis continues without
// the step. Returns true if the step succeeded.
template <typename Step>
bool attempted(const char* what, Diagnosed& one, stage::Work& work, Step step) {
  const auto note = [&](const std::exception& e) {
    one.result.notes.push_back(fmt::format("{}: {}", what, e.what()));
    work.warn(one.result.notes.back());
  };
  try {
    step();
    return true;
  } catch (const Interrupted&) {
    throw;
  } catch (const InvalidInput& e) {
    note(e);
  } catch (const NumericalFailure& e) {
    note(e);
  } catch (const OutOfResources& e) {
    note(e);
  } catch (const std::bad_alloc& e) {
    note(e);
  }
  return false;
}

// Adds a comment at the top of the extended study.
void comment_on(const std::string& comment, Diagnosed& one) {
  if (one.extended) one.extended->text = "# " + comment + "\n" + one.extended->text;
}

// Returns true if causes were named.
bool extend_by_causes(const study::Study& study, double band_hz, const SolveStudy& solve,
                      Diagnosed& one, stage::Work& work) {
  if (causes_to_extend(one).empty()) return false;
  const bool is_solved = attempted("the extended study cannot be solved", one, work,
                                   [&] { extend(study, band_hz, solve, one, work); });
  if (!is_solved) comment_on("This study could not be solved.", one);
  return true;
}

void add_gain(const study::Study& study, double band_hz, const SolveStudy& solve, Diagnosed& one,
              stage::Work& work) {
  if (extend_by_causes(study, band_hz, solve, one, work)) {
    if (one.predictions.extended.empty() || !one.extended->unexpressed.empty()) {
      attempted("the fitted model cannot predict", one, work,
                [&] { one.predictions.fitted = fitted_model(one); });
    }
  }
  const auto& tested = one.result.cross_validation;
  one.gain = gain_of(one.measured, plan_of(study), study.measurement->hold_out, one.predictions,
                     tested ? &*tested : nullptr);
  if (is_of_modes(one) && is_less_good(one, options_of(plan_of(study), work))) {
    judge_by_modes(one.modes_compared, one.gain);
  }
  const auto advice = advice_against(one.gain);
  if (advice.empty()) return;
  work.warn(advice);
  if (one.gain.pays) comment_on(advice, one);
}

stage::Solution solve_in_full(const study::Study& extended, stage::Work& work) {
  return stage::solved(extended, work);
}

// Notes the faces on which causes are sought, and returns the options.
diagnosis::DiagnosisOptions prepare(const study::Study& study, Diagnosed& one, stage::Work& work) {
  for (const auto& note : stage::diagnosed_faces(study, one.before.model.body).notes) {
    work.note(note);
  }
  if (!study.sheet.empty()) {
    work.note("length, width and mass are compared between specimens alone: they stay as written");
  }
  auto options = options_of(plan_of(study), work);
  one.least_evidence = options.least_evidence;
  options.constants = constants_of(study, one.structure.surface);
  return options;
}

Diagnosed diagnosed(const study::Study& study, MeasuredFrfs measured, stage::Solution before,
                    stage::Work& work, const SolveStudy& solve_extended) {
  Diagnosed one;
  one.before = std::move(before);
  const auto found = compare_responses(study, std::move(measured), one, work);
  one.identified = found.fit;
  auto options = prepare(study, one, work);
  // What scales all records alike is not told by records without units.
  if (!found.scaled) options.tolerances.scale = std::max(options.tolerances.scale, 0.3);
  if (one.identified) one.modes_compared = modes_of_responses(one, *one.identified, nullptr);
  const auto start = start_by_modes(one, found.scaled, options, work);
  const auto ask_modes = [&] {
    attempted("the modes of the responses cannot be diagnosed", one, work,
              [&] { diagnose_modes(one, start.modes, options, work); });
  };
  if (has_other_modes(one, options)) ask_modes();
  const auto search = [&](const diagnosis::DiagnosisOptions& how) {
    one.result = work.timed(
        "diagnosis", [&] { return diagnosis::diagnosed(one.structure, one.seen, how, start); });
  };
  const auto beside = beside_modes(one, options);
  search(beside);
  if (beside.is_look && is_promising(one)) search(options);
  if (is_open(one) && !one.by_modes) ask_modes();
  take_answer_of_modes(one, options);
  one.detectable = work.timed("detectable sizes", [&] {
    return diagnosis::detectable(one.structure, one.seen, beside_errors(one, options));
  });
  add_gain(study, found.band_hz, solve_extended, one, work);
  believe_what_pays(one);
  one.errors = work.timed("errors over frequency",
                          [&] { return errors_over_frequency(one, options.tolerances); });
  return one;
}

Diagnosed diagnosed_by_modes(const study::Study& study, const ModesOfFiles& files,
                             stage::Solution before, stage::Work& work,
                             const SolveStudy& solve_extended) {
  Diagnosed one;
  one.before = std::move(before);
  const double band_hz = compare_modes(study, files.modes, one, work);
  if (files.reference) {
    one.reference = files.reference;
    one.reference_file = study.measurement->reference.filename().string();
  }
  const auto options = prepare(study, one, work);
  one.result = work.timed("diagnosis", [&] {
    if (one.reference) {
      return diagnosis::diagnosed(one.structure, *one.modes, *one.reference, options);
    }
    return diagnosis::diagnosed(one.structure, *one.modes, options);
  });
  drop_mac_without_shapes(one);
  extend_by_causes(study, band_hz, solve_extended, one, work);
  return one;
}

}  // namespace

Diagnosed diagnosed(const study::Study& study, stage::Work& work,
                    const SolveStudy& solve_extended) {
  if (is_by_modes(study)) {
    const auto modes = modes_of_files(study, work);  // likewise before minutes of solving
    auto before = stage::solved(stage::with_modes_for_diagnosis(study), work);
    return diagnosed_by_modes(study, modes, std::move(before), work, solve_extended);
  }
  auto measured = measured_frfs(study, work);  // reports missing data before minutes of solving
  auto before = stage::solved(stage::with_modes_for_diagnosis(study), work);
  return diagnosed(study, std::move(measured), std::move(before), work, solve_extended);
}

Diagnosed diagnosed(const study::Study& study, stage::Work& work) {
  return diagnosed(study, work, solve_in_full);
}

Diagnosed diagnosed(const study::Study& study, stage::Solution before, stage::Work& work) {
  if (is_by_modes(study)) {
    return diagnosed_by_modes(study, modes_of_files(study, work), std::move(before), work,
                              solve_in_full);
  }
  return diagnosed(study, measured_frfs(study, work), std::move(before), work, solve_in_full);
}

}  // namespace chladni::steps
