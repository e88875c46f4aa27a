#include "steps/compared.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "base/error.h"
#include "diagnosis/diagnosed_modes.h"
#include "stage/channel_paths.h"
#include "stage/diagnosis_structure.h"
#include "steps/diagnosis/beside_measured.h"
#include "steps/diagnosis/by_modes.h"
#include "steps/diagnosis/responses_in_band.h"
#include "steps/measured_modes.h"

namespace chladni::steps {
namespace {

using Eigen::Index;

// The measurement without held-out channels and lines.
modal::FrfSet seen_of(const MeasuredFrfs& measured, const study::DiagnosisPlan& plan) {
  const auto part = modal::part(measured.all, measured.outputs, measured.inputs);
  if (plan.hold_out_high_hz <= 0.0) return part;
  return modal::outside_band(part, plan.hold_out_low_hz, plan.hold_out_high_hz);
}

// Number of time derivatives in the record of a sensor.
Index derivatives(const study::Study& study, const std::string& sensor) {
  const auto at = index_of(study.sensors, sensor);
  if (at < 0) return 0;
  const auto& quantity = study.sensors[static_cast<std::size_t>(at)].quantity;
  return quantity == "acceleration" ? 2 : quantity == "velocity" ? 1 : 0;
}

std::optional<identification::ModalFit> compare(const study::Study& study, Compared& one,
                                                stage::Work& work) {
  auto fit = modes_of(one.seen, one.measured.variance_stated, study, work);
  one.comparison = diagnosis::compared(one.structure, one.seen, fit ? &*fit : nullptr);
  return fit;
}

// Records without units have an unknown scale, so they get the scale of the simulation. Where some
// state theirs, these have the scale, and the others are taken as they are. Returns true if the
// scale was changed.
bool take_scale(Compared& one, stage::Work& work) {
  std::vector<std::string> unstated;
  for (const auto& channel : one.measured.all.outputs) {
    if (channel.unit.empty()) unstated.push_back(channel.name);
  }
  if (unstated.empty()) return false;
  if (unstated.size() < one.measured.all.outputs.size()) {
    work.warn(fmt::format("{}: no unit is stated, though other sensors state theirs: taken as m",
                          fmt::join(unstated, ", ")));
    return false;
  }
  const double level = one.comparison.responses.level;
  if (!(level > 0.0) || !std::isfinite(level)) return false;
  work.note(
      fmt::format("no units are stated: all responses are divided by {:.4g}, the median "
                  "of measured over simulated; what scales them all is not told",
                  level));
  for (auto* set : {&one.measured.all, &one.seen}) {
    for (auto& value : set->value) value /= level;
    for (auto* variances : {&set->variance, &set->noise_variance}) {
      for (auto& variance : *variances) variance /= level * level;
    }
  }
  return true;
}

void take_structure(const study::Study& study, double band_hz, Compared& one, stage::Work& work) {
  one.structure =
      work.timed("structure", [&] { return stage::structure_of(study, one.before, band_hz); });
}

std::vector<diagnosis::ModeTold> modes_beside(const study::Study& study, const Compared& one,
                                              stage::Work& work) {
  auto options = options_of(plan_of(study), work);
  options.most_causes = 0;
  auto told = diagnosis::diagnosed(one.structure, *one.modes, options).modes;
  if (one.modes->outputs.empty() && one.modes->inputs.empty()) {
    for (auto& mode : told) mode.mac_before = std::numeric_limits<double>::quiet_NaN();
  }
  return told;
}

}  // namespace

std::vector<Index> places(const std::vector<modal::MeasuredChannel>& channels,
                          const std::vector<std::string>& names) {
  std::vector<Index> rows;
  for (const auto& channel : channels) {
    rows.push_back(std::ranges::find(names, channel.name) - names.begin());
  }
  return rows;
}

std::vector<Eigen::MatrixXcd> predicted(const study::Study& study,
                                        const diagnosis::Structure& structure,
                                        const study::Study& recorder,
                                        const modal::FrfSet& measured) {
  const auto model = diagnosis::reduced_model(structure);
  const auto simulated = modal::frf(model, measured.frequency_hz);
  modal::FrfSet set = measured;
  const auto rows = places(measured.outputs, structure.outputs.names);
  const auto cols = places(measured.inputs, structure.inputs.names);
  for (std::size_t k = 0; k < set.value.size(); ++k) {
    set.value[k] = simulated.value[k](rows, cols);
    const std::complex<double> s(
        0.0, 2.0 * std::numbers::pi * measured.frequency_hz(static_cast<Index>(k)));
    for (std::size_t i = 0; i < measured.outputs.size(); ++i) {
      const auto& sensor = measured.outputs[i].name;
      const auto more = derivatives(study, sensor) - derivatives(recorder, sensor);
      if (more != 0) set.value[k].row(static_cast<Index>(i)) *= std::pow(s, more);
    }
  }
  return stage::without_paths(recorder, stage::recorded(study, std::move(set))).value;
}

ComparedResponses compare_responses(const study::Study& study, MeasuredFrfs measured, Compared& one,
                                    stage::Work& work) {
  const auto plan = plan_of(study);
  const double highest_hz = 0.9 * one.before.modes.frequency_hz.tail(1)(0);
  one.measured = within_band(std::move(measured), study, plan, highest_hz, work);
  one.seen = seen_of(one.measured, plan);
  ComparedResponses all;
  all.band_hz = one.measured.all.frequency_hz.tail(1)(0);
  take_structure(study, all.band_hz, one, work);
  all.fit = work.timed("comparison", [&] {
    auto found = compare(study, one, work);
    all.scaled = !take_scale(one, work);
    return all.scaled ? found : compare(study, one, work);
  });
  one.predictions.before = predicted(study, one.structure, study, one.measured.all);
  return all;
}

double compare_modes(const study::Study& study, const diagnosis::MeasuredModes& all, Compared& one,
                     stage::Work& work) {
  one.modes = modes_below(0.9 * one.before.modes.frequency_hz.tail(1)(0), all, study, work);
  const double band_hz = one.modes->frequency_hz.tail(1)(0);
  take_structure(study, band_hz, one, work);
  return band_hz;
}

bool is_by_modes(const study::Study& study) {
  return study.measurement && has_modes(*study.measurement);
}

StudyComparison compared(const study::Study& study, stage::Work& work) {
  require(study.measurement.has_value(),
          study.file.string() +
              ": nothing is measured; expected [measurement] with frf, time or "
              "modes");
  StudyComparison one;
  const auto solve = [&] {
    one.before = stage::solved(stage::with_modes_for_diagnosis(study), work);
  };
  if (is_by_modes(study)) {  // missing data are reported before minutes of solving
    const auto modes = measured_modes(study, work);
    solve();
    static_cast<void>(compare_modes(study, modes, one, work));
    one.modes_beside = modes_beside(study, one, work);
    return one;
  }
  auto measured = measured_frfs(study, work);
  solve();
  static_cast<void>(compare_responses(study, std::move(measured), one, work));
  return one;
}

}  // namespace chladni::steps
