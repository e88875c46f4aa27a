#include "app/diagnosis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/channel_paths.h"
#include "app/diagnosis_structure.h"
#include "app/study_parts.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "identification/fit_data.h"
#include "identification/identified.h"

namespace chladni::app {
namespace {

using Eigen::Index;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr Index kMostFitted = 200;  // responses: of more, modes are not identified beside

DiagnosisPlan plan_of(const Study& study) { return study.diagnosis.value_or(DiagnosisPlan{}); }

// Variances that the file does not state are estimated from how much the lines scatter.
void state_variance(modal::FrfSet& set, Run& run) {
  if (!set.variance.empty()) return;
  const auto data = identification::fit_data(set);
  run.talk().warn(
      "the measured responses state no variance: it is estimated from their scatter, and "
      "with it every probability");
  Eigen::MatrixXd nothing = Eigen::MatrixXd::Constant(set.output_count(), set.input_count(), kNone);
  set.variance.assign(set.value.size(), nothing);
  Index line = 0;
  for (Index k = 0; k < set.line_count(); ++k) {
    if (set.frequency_hz(k) <= 0.0) continue;
    const Eigen::VectorXd weight = data.weight.row(line++).transpose();
    set.variance[static_cast<std::size_t>(k)] =
        (weight.array() > 0.0)
            .select(weight.array().square().inverse(), kNone)
            .matrix()
            .reshaped(set.output_count(), set.input_count());
  }
}

MeasuredFrfs measured_within(const Study& study, const DiagnosisPlan& plan, double highest_hz,
                             Run& run) {
  auto measured = measured_frfs(study, run);
  auto& set = measured.all;
  set = modal::converted(set, modal::FrfKind::receptance);
  const double high = plan.high_hz > 0.0 ? plan.high_hz : highest_hz;
  const double last_hz = std::min(high, highest_hz);
  const double first_hz = std::max(plan.low_hz, 1e-9);
  const auto within =
      (set.frequency_hz.array() >= first_hz && set.frequency_hz.array() <= last_hz).count();
  require(within >= 16,
          fmt::format("{}: {} measured lines ({:.6g} to {:.6g} Hz were measured) lie within the "
                      "band of the diagnosis and below {:.6g} Hz, where the simulation's modes "
                      "end; at least 16 are expected",
                      study.file.string(), within, set.frequency_hz.minCoeff(),
                      set.frequency_hz.maxCoeff(), highest_hz));
  set = modal::band(set, first_hz, last_hz);
  state_variance(set, run);
  return measured;
}

bool line_held_out(const DiagnosisPlan& plan, double frequency_hz) {
  return plan.hold_out_high_hz > 0.0 && frequency_hz >= plan.hold_out_low_hz &&
         frequency_hz <= plan.hold_out_high_hz;
}

// Without held-out channels and lines.
modal::FrfSet seen_of(const MeasuredFrfs& measured, const DiagnosisPlan& plan) {
  const auto part = modal::part(measured.all, measured.outputs, measured.inputs);
  if (plan.hold_out_high_hz <= 0.0) return part;
  auto below = modal::band(part, 0.0, std::nextafter(plan.hold_out_low_hz, 0.0));
  const auto above = modal::band(part, std::nextafter(plan.hold_out_high_hz, HUGE_VAL),
                                 part.frequency_hz.maxCoeff());
  const Index lines = below.line_count() + above.line_count();
  Eigen::VectorXd frequency(lines);
  frequency << below.frequency_hz, above.frequency_hz;
  below.frequency_hz = frequency;
  const auto append = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  append(below.value, above.value);
  append(below.variance, above.variance);
  append(below.noise_variance, above.noise_variance);
  append(below.coherence, above.coherence);
  return below;
}

// What a study predicts where something was measured, as the records of `recorder` have it.
std::vector<Eigen::MatrixXcd> predicted(const Study& study, const diagnosis::Structure& structure,
                                        const Study& recorder, const modal::FrfSet& measured) {
  const auto model = diagnosis::reduced_model(structure);
  const auto simulated = modal::frf(model, measured.frequency_hz);
  modal::FrfSet set = measured;
  const auto rows_of = [](const std::vector<modal::MeasuredChannel>& channels,
                          const std::vector<std::string>& names) {
    std::vector<Index> rows;
    for (const auto& channel : channels) {
      rows.push_back(std::ranges::find(names, channel.name) - names.begin());
    }
    return rows;
  };
  const auto rows = rows_of(measured.outputs, structure.outputs.names);
  const auto cols = rows_of(measured.inputs, structure.inputs.names);
  for (std::size_t k = 0; k < set.value.size(); ++k) set.value[k] = simulated.value[k](rows, cols);
  return without_paths(recorder, recorded(study, std::move(set))).value;
}

// Sums over some responses and lines.
struct Sums {
  double error = 0.0, size = 0.0, noise = 0.0;
  [[nodiscard]] double relative() const { return size > 0.0 ? std::sqrt(error / size) : kNone; }
  [[nodiscard]] double floor() const { return size > 0.0 ? std::sqrt(noise / size) : kNone; }
};

Sums sums_of(const Diagnosed& one, const std::vector<Eigen::MatrixXcd>& response,
             const Study& study, bool held_out) {
  const auto& measured = one.measured.all;
  Sums sums;
  for (std::size_t k = 0; k < response.size(); ++k) {
    const bool line = line_held_out(plan_of(study), measured.frequency_hz(static_cast<Index>(k)));
    for (Index j = 0; j < response[k].cols(); ++j) {
      for (Index i = 0; i < response[k].rows(); ++i) {
        const bool seen = !line && std::ranges::binary_search(one.measured.outputs, i) &&
                          std::ranges::binary_search(one.measured.inputs, j);
        const auto value = measured.value[k](i, j);
        if (seen == held_out || !std::isfinite(std::abs(value))) continue;
        sums.error += std::norm(value - response[k](i, j));
        sums.size += std::norm(value);
        sums.noise += measured.variance[k](i, j);
      }
    }
  }
  return sums;
}

Gain gain_of(const Diagnosed& one, const Study& study) {
  Gain gain;
  const auto& after = one.response_after.empty() ? one.response_before : one.response_after;
  const auto seen = sums_of(one, one.response_before, study, false);
  const auto held = sums_of(one, one.response_before, study, true);
  gain.fit_before = seen.relative();
  gain.noise_floor = seen.floor();
  gain.held_out_before = held.relative();
  gain.held_out_noise = held.floor();
  gain.fit_after = sums_of(one, after, study, false).relative();
  gain.held_out_after = sums_of(one, after, study, true).relative();
  for (const auto& name : study.measurement->hold_out) gain.held_out.push_back(name);
  const auto plan = plan_of(study);
  if (plan.hold_out_high_hz > 0.0) {
    gain.held_out.push_back(
        fmt::format("{:.6g} to {:.6g} Hz", plan.hold_out_low_hz, plan.hold_out_high_hz));
  }
  gain.pays = !std::isfinite(gain.held_out_before) || gain.held_out_after < gain.held_out_before;
  return gain;
}

// Modes of what was measured, for the comparison; none where they cannot be identified.
std::optional<identification::ModalFit> modes_of(const modal::FrfSet& seen, Run& run) {
  if (seen.output_count() * seen.input_count() > kMostFitted) return std::nullopt;
  try {
    identification::IdentificationOptions options;
    options.rigid_count = -1;
    options.fit.delay = true;
    return identification::identified(identification::fit_data(seen), options).fit;
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& e) {
    run.talk().note(std::string("no modes were identified for the comparison: ") + e.what());
    return std::nullopt;
  }
}

diagnosis::DiagnosisOptions options_of(const DiagnosisPlan& plan, Run& run) {
  diagnosis::DiagnosisOptions options;
  options.tolerances = plan.tolerances;
  options.lines = plan.lines;
  options.most_causes = plan.most_causes;
  options.least_evidence = plan.least_evidence;
  options.rival_within = plan.rival_within;
  options.only = plan.effects;
  options.progress = run.talk().progress();
  return options;
}

void compare(Diagnosed& one, Run& run) {
  const auto fit = modes_of(one.seen, run);
  one.comparison = diagnosis::compared(one.structure, one.seen, fit ? &*fit : nullptr);
}

// Records without units have a scale of their own: that of the simulation is given to them. Whether
// it was.
bool take_scale(Diagnosed& one, diagnosis::Tolerances& tolerances, Run& run) {
  const auto unstated = [](const modal::MeasuredChannel& channel) { return channel.unit.empty(); };
  if (std::ranges::none_of(one.measured.all.outputs, unstated)) return false;
  const double level = one.comparison.responses.level;
  if (!(level > 0.0) || !std::isfinite(level)) return false;
  run.talk().note(
      fmt::format("no units are stated: all responses are divided by {:.4g}, the median "
                  "of measured over simulated; what scales them all is not told",
                  level));
  for (auto* set : {&one.measured.all, &one.seen}) {
    for (auto& value : set->value) value /= level;
    for (auto& variance : set->variance) variance /= level * level;
  }
  tolerances.scale = std::max(tolerances.scale, 0.3);
  return true;
}

// The extended study, solved in full; not made where nothing was named.
void extend(const Study& study, double band_hz, Diagnosed& one, Run& run) {
  if (one.result.best.causes.empty() || one.result.verdict == diagnosis::Verdict::unexplained) {
    return;
  }
  auto allowed = run.options().allowed;
  allowed.push_back(std::filesystem::absolute(study.file).parent_path());  // its data stay there
  auto extension = extended_study(read_whole(study.file), study.file, one.structure.surface,
                                  one.result.best.causes, run / "", allowed);
  const auto part = run.part("extended: ");
  const Study extended =
      with_modes_for_diagnosis(parse_study(extension.text, run / "extended.toml", allowed));
  one.after = solved(extended, run);
  one.response_after =
      predicted(extended, structure_of(extended, *one.after, band_hz), study, one.measured.all);
  one.extended = std::move(extension);
}

}  // namespace

Diagnosed diagnosed(const Study& study, Run& run) {
  const auto plan = plan_of(study);
  Diagnosed one;
  one.before = solved(with_modes_for_diagnosis(study), run);
  const Solution& solution = one.before;
  const double highest_hz = 0.9 * solution.modes.frequency_hz.tail(1)(0);
  one.measured = measured_within(study, plan, highest_hz, run);
  one.seen = seen_of(one.measured, plan);
  const double band_hz = one.measured.all.frequency_hz.tail(1)(0);
  one.structure = run.timed("structure", [&] { return structure_of(study, solution, band_hz); });
  auto options = options_of(plan, run);
  run.timed("comparison", [&] {
    compare(one, run);
    if (take_scale(one, options.tolerances, run)) compare(one, run);
    return 0;
  });
  one.result = run.timed("diagnosis",
                         [&] { return diagnosis::diagnosed(one.structure, one.seen, options); });
  one.detectable = run.timed(
      "detectable sizes", [&] { return diagnosis::detectable(one.structure, one.seen, options); });
  one.response_before = predicted(study, one.structure, study, one.measured.all);
  try {
    extend(study, band_hz, one, run);
  } catch (const InvalidInput& e) {
    run.talk().warn(std::string("the extended study cannot be: ") + e.what());
  }
  one.gain = gain_of(one, study);
  if (one.gain.pays) return one;
  run.talk().warn("the extension does not pay on what was held out: it is not made");
  one.extended.reset();
  return one;
}

}  // namespace chladni::app
