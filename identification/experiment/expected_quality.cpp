#include "identification/experiment/expected_quality.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/turn.h"
#include "base/upper_median.h"
#include "identification/experiment/expected_fit.h"

namespace chladni::identification {
namespace {

constexpr double kFewLines = 2.0;  // in the half-power bandwidth

// K×pq: E|G − G₀|² of receptances from one period of one realisation.
Eigen::MatrixXd variance_of(const QualityInputs& in) {
  const auto p = in.noise.cols();
  const auto q = in.power.cols();
  const auto kinds = kind_power(in.model.kinds, in.lines.hz);
  Eigen::MatrixXd variance(in.noise.rows(), p * q);
  for (Eigen::Index j = 0; j < q; ++j) {
    for (Eigen::Index i = 0; i < p; ++i) {
      variance.col(i + p * j) =
          in.noise.col(i).array() /
          (kinds.col(i).array() * in.power.col(j).array() * in.lines.hold.array().square());
    }
  }
  return variance;
}

Eigen::Index recorded_experiments(const QualityInputs& in) { return in.power.cols(); }

std::string reason(const QualityInputs& in, const ExpectedMode& mode) {
  if (mode.drive < kHardlyMoves) return "no actuator moves it";
  if (mode.sight < kHardlyMoves) return "no sensor sees it";
  const double hours = mode.seconds_needed / 3600.0;
  if (!std::isfinite(hours)) return "it stays below the noise";
  return fmt::format("it needs {:.3g} {} of recording, and the experiment may last {:.3g} min",
                     hours < 1.0 ? 60.0 * hours : hours, hours < 1.0 ? "min" : "h",
                     in.plan.longest_s / 60.0);
}

ExpectedMode looked_at(const QualityInputs& in, Eigen::Index mode) {
  const auto& model = in.model.model;
  const double largest = std::max(in.model.largest(mode), 1e-300);
  const auto p = static_cast<Eigen::Index>(in.model.kinds.size());
  return {.mode = mode,
          .frequency_hz = model.frequency_hz(mode),
          .damping_ratio = model.damping_ratio(mode),
          .drive = model.input_shapes.row(mode).cwiseAbs().maxCoeff() / largest,
          .sight = model.output_shapes.col(mode).head(p).cwiseAbs().maxCoeff() / largest,
          .why = ""};
}

// Deviations after one period of one realisation of every experiment.
void set_bounds(const QualityInputs& in, ExperimentDesign& design) {
  const auto band = modes_in_band(in.model.model, in.plan);
  std::vector<Eigen::Index> fitted(static_cast<std::size_t>(in.model.model.rigid_count));
  for (std::size_t k = 0; k < fitted.size(); ++k) fitted[k] = static_cast<Eigen::Index>(k);
  for (const auto k : in.within_reach) fitted.push_back(band[static_cast<std::size_t>(k)]);
  for (const auto k : band) design.modes.push_back(looked_at(in, k));
  if (in.within_reach.empty()) return;
  auto model = with_modes(in.model.model, fitted);
  const auto p = in.noise.cols();
  model.output_shapes = Eigen::MatrixXd(model.output_shapes.topRows(p));
  model.residual = Eigen::MatrixXd(model.residual.topRows(p));
  const auto fit = expected_fit(model, in.lines.hz, variance_of(in));
  for (std::size_t i = 0; i < in.within_reach.size(); ++i) {
    auto& mode = design.modes[static_cast<std::size_t>(in.within_reach[i])];
    const auto at = fit.model.rigid_count + static_cast<Eigen::Index>(i);
    mode.frequency_std_hz = fit.frequency_std_hz(at);
    mode.damping_std = fit.damping_std(at) / mode.damping_ratio;
  }
}

void set_periods(const QualityInputs& in, ExperimentDesign& design) {
  const double all = static_cast<double>(recorded_experiments(in)) * in.plan.realisations;
  const double period = design.period_s();
  const double around =
      all * (static_cast<double>(design.settle) * period +
             static_cast<double>(design.ramp) * design.sample_time_s);  // not recorded
  const double most = std::max(2.0, std::floor((in.plan.longest_s - around) / (all * period)));
  double needed = 2.0;
  for (auto& mode : design.modes) {
    const double averages = averages_needed(mode, in.plan.frequency_std_hz, in.plan.damping_std);
    mode.seconds_needed = averages * period * static_cast<double>(recorded_experiments(in));
    const double periods = std::ceil(averages / in.plan.realisations);
    mode.reached = periods <= most;
    if (mode.reached) needed = std::max(needed, periods);
  }
  design.periods = static_cast<Eigen::Index>(needed);
  design.duration_s = around + all * needed * period;
  const double averages = needed * in.plan.realisations;
  for (auto& mode : design.modes) {
    mode.frequency_std_hz /= std::sqrt(averages);
    mode.damping_std /= std::sqrt(averages);
    if (!mode.reached) mode.why = reason(in, mode);
  }
}

void add_notes(const QualityInputs& in, ExperimentDesign& design) {
  if (design.duration_s > in.plan.longest_s) {
    design.notes.push_back(fmt::format(
        "the shortest experiment of two periods and {} realisations lasts {:.3g} min; expected a "
        "longer one, fewer realisations, a shorter longest_period or all actuators at once",
        in.plan.realisations, design.duration_s / 60.0));
  }
  for (const auto& mode : design.modes) {
    const double lines = 2.0 * mode.damping_ratio * mode.frequency_hz / design.spacing_hz;
    if (lines >= kFewLines) continue;
    design.notes.push_back(fmt::format(
        "the mode at {:.6g} Hz has {:.2g} lines in its half-power bandwidth: a period "
        "of {:.4g} s resolves it",
        mode.frequency_hz, lines, in.plan.lines_per_bandwidth / lines * design.period_s()));
  }
  if (in.model.model.rigid_count > 0) {
    design.notes.push_back(fmt::format(
        "the body is free ({} rigid-body modes): hang it softly or hold it in a loop; in a loop "
        "the signals are references, and the forces are smaller within its bandwidth",
        in.model.model.rigid_count));
  }
}

}  // namespace

double averages_needed(const ExpectedMode& mode, double frequency_std_hz, double damping_std) {
  const double worst =
      std::max(mode.frequency_std_hz / frequency_std_hz, mode.damping_std / damping_std);
  return worst * worst;
}

std::vector<ExpectedCoherence> expected_coherence(const Eigen::VectorXd& hz,
                                                  const std::vector<Eigen::MatrixXcd>& response,
                                                  const Eigen::MatrixXd& kinds,
                                                  const Eigen::MatrixXd& power,
                                                  const Eigen::MatrixXd& noise) {
  std::vector<ExpectedCoherence> result;
  for (Eigen::Index j = 0; j < power.cols(); ++j) {
    for (Eigen::Index i = 0; i < noise.cols(); ++i) {
      std::vector<double> each;
      ExpectedCoherence one{.output = i, .input = j, .lowest = 2.0};
      for (Eigen::Index k = 0; k < hz.size(); ++k) {
        const double signal =
            std::norm(response[static_cast<std::size_t>(k)](i, j)) * kinds(k, i) * power(k, j);
        each.push_back(signal / (signal + noise(k, i)));
        if (each.back() >= one.lowest) continue;
        one.lowest = each.back();
        one.lowest_hz = hz(k);
      }
      one.median = upper_median(each);
      result.push_back(one);
    }
  }
  return result;
}

void set_expected_quality(const QualityInputs& inputs, ExperimentDesign& design) {
  set_bounds(inputs, design);
  set_periods(inputs, design);
  const double times = excitations(inputs.plan, inputs.power.cols());
  design.coherence = expected_coherence(inputs.lines.hz, inputs.lines.response,
                                        kind_power(inputs.model.kinds, inputs.lines.hz),
                                        inputs.power / times, inputs.noise);
  add_notes(inputs, design);
}

}  // namespace chladni::identification
