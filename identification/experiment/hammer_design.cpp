#include "identification/hammer_design.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/error.h"
#include "base/turn.h"
#include "identification/experiment/amplitude_shape.h"
#include "identification/experiment/design_lines.h"
#include "identification/experiment/expected_fit.h"
#include "identification/experiment/expected_quality.h"

namespace chladni::identification {
namespace {

using Eigen::Index;

constexpr double kAtRest = 0.01;  // of the response, at the end of a record
constexpr double kPulseTurns =
    1.02;  // f τ at which the spectrum of half a sine has fallen by 10 dB
constexpr Index kFewestHits = 3;
constexpr Index kMostPoints = 8;
constexpr double kWorthAPoint = 0.9;  // of the blows without it

// Magnitude of the spectrum of half a sine of peak 1 [s].
double pulse_spectrum(double hz, double pulse_s) {
  const double x = hz * pulse_s;
  const double gap = 1.0 - 4.0 * x * x;
  const double shape =
      std::abs(gap) < 1e-9 ? 0.25 * std::numbers::pi : std::cos(std::numbers::pi * x) / gap;
  return std::abs(2.0 * pulse_s / std::numbers::pi * shape);
}

// The design's own plan, as far as it is that of a multisine.
DesignPlan lines_plan(const HammerPlan& plan) {
  return {.sample_time_s = plan.sample_time_s,
          .low_hz = plan.low_hz,
          .high_hz = plan.high_hz,
          .sensor_noise = plan.sensor_noise,
          .force_limit_n = plan.force_limit_n,
          .frequency_std_hz = plan.frequency_std_hz,
          .damping_std = plan.damping_std};
}

void check(const DesignModel& model, const Eigen::MatrixXd& candidates, const HammerPlan& plan) {
  require(candidates.rows() >= 1 && candidates.cols() == model.model.mode_count(),
          "hammer design: there is no point to hit");
  require(!model.kinds.empty(), "hammer design: expected a sensor or more");
  require(std::isfinite(plan.force_limit_n) && plan.force_limit_n > 0.0,
          "hammer design: expected the peak force of a blow as a limit");
  require(plan.sensor_noise.size() == static_cast<Index>(model.kinds.size()) &&
              plan.sensor_noise.minCoeff() > 0.0,
          "hammer design: the sensors have no noise, so any measurement is perfect; expected the "
          "rms of their noise");
  require(plan.high_hz > plan.low_hz && plan.high_hz < 0.5 / plan.sample_time_s,
          fmt::format("hammer design: the band is {:.6g} to {:.6g} Hz; expected it ascending and "
                      "below {:.6g} Hz, half the sampling frequency",
                      plan.low_hz, plan.high_hz, 0.5 / plan.sample_time_s));
}

// Length of a record, and the window that it needs where it ends too early.
void set_record(const modal::ReducedModel& model, const std::vector<Index>& modes,
                const HammerPlan& plan, HammerDesign& design) {
  double slowest = 1e300;
  for (Index k = model.rigid_count; k < model.mode_count(); ++k) {
    if (model.frequency_hz(k) > plan.high_hz) continue;
    slowest = std::min(slowest, kTwoPi * model.damping_ratio(k) * model.frequency_hz(k));
  }
  for (const auto k : modes) {
    require(model.damping_ratio(k) > 0.0,
            fmt::format("hammer design: the mode at {:.6g} Hz has no damping and never comes to "
                        "rest; expected modes.damping_ratio above 0",
                        model.frequency_hz(k)));
  }
  const double wanted = -std::log(kAtRest) / slowest;
  design.record_s = std::min({wanted, plan.longest_record_s, kMostSamples * plan.sample_time_s});
  design.samples = 2 * static_cast<Index>(std::ceil(0.5 * design.record_s / plan.sample_time_s));
  design.record_s = static_cast<double>(design.samples) * plan.sample_time_s;
  if (wanted > design.record_s) {
    design.exponential_s = 1.0 / (-std::log(kAtRest) / design.record_s - slowest);
    design.notes.push_back(fmt::format(
        "the slowest mode rings for {:.3g} s; the exponential window of {:.3g} s ends the record "
        "and adds {:.3g} rad/s to every decay, which is taken off again",
        wanted, design.exponential_s, 1.0 / design.exponential_s));
  }
  design.pulse_s = plan.pulse_s > 0.0 ? plan.pulse_s : kPulseTurns / plan.high_hz;
  design.force_window_s = 2.0 * design.pulse_s;
  design.peak_n = plan.force_limit_n;
  design.fall_db =
      20.0 * std::log10(pulse_spectrum(0.0, design.pulse_s) /
                        std::max(pulse_spectrum(plan.high_hz, design.pulse_s), 1e-300));
}

/// Lines of a record with the force and the noise on them.
struct Blow {
  Eigen::VectorXd hz;
  Eigen::VectorXd power;  // K: |F|² of one blow
  Eigen::MatrixXd noise;  // K×p: E|N|²
};

Blow blow_of(const HammerPlan& plan, const HammerDesign& design) {
  const auto first =
      std::max<Index>(1, static_cast<Index>(std::ceil(plan.low_hz * design.record_s)));
  const auto last = static_cast<Index>(std::floor(plan.high_hz * design.record_s));
  require(last >= first,
          fmt::format("hammer design: no line between {:.6g} and {:.6g} Hz; the lines of a record "
                      "of {:.4g} s lie {:.6g} Hz apart; expected a wider band or a longer record",
                      plan.low_hz, plan.high_hz, design.record_s, 1.0 / design.record_s));
  Blow record{Eigen::VectorXd(last - first + 1), Eigen::VectorXd(last - first + 1), {}};
  for (Index k = 0; k < record.hz.size(); ++k) {
    record.hz(k) = static_cast<double>(first + k) / design.record_s;
    const double force =
        design.peak_n * pulse_spectrum(record.hz(k), design.pulse_s) / plan.sample_time_s;
    record.power(k) = std::max(force * force, 1e-300);
  }
  double samples = static_cast<double>(design.samples);  // Σ w² of the window
  if (design.exponential_s > 0.0) {
    const double twice = 2.0 * plan.sample_time_s / design.exponential_s;
    samples = (1.0 - std::exp(-twice * samples)) / (1.0 - std::exp(-twice));
  }
  record.noise = samples * plan.sensor_noise.cwiseAbs2().transpose().replicate(record.hz.size(), 1);
  return record;
}

// Blows that each mode needs where it moves by 1 kg^-1/2, as if it were alone.
Eigen::VectorXd blows_at_one(const DesignModel& model, const HammerPlan& plan, const Blow& record,
                             const std::vector<Index>& modes) {
  const auto p = static_cast<Index>(model.kinds.size());
  const Eigen::MatrixXd seen = kind_power(model.kinds, record.hz).cwiseQuotient(record.noise);
  const Eigen::MatrixXd shapes = model.model.output_shapes(Eigen::seqN(0, p), modes);
  const ShapeProblem problem{.line_hz = record.hz,
                             .frequency_hz = model.model.frequency_hz(modes),
                             .damping_ratio = model.model.damping_ratio(modes),
                             .sight = seen * shapes.cwiseAbs2(),
                             .drive = Eigen::MatrixXd::Ones(static_cast<Index>(modes.size()), 1),
                             .frequency_std_hz = plan.frequency_std_hz,
                             .damping_std = plan.damping_std,
                             .simulation_error = 0.0};
  return expected_variance(problem, record.power);
}

// Blows in all for these points, each hit equally often: n_i / mean r².
double blows_needed(const Eigen::VectorXd& at_one, const Eigen::MatrixXd& squared,
                    const std::vector<Index>& points) {
  const Eigen::VectorXd mean = squared(points, Eigen::all).colwise().mean().transpose();
  const double needed = at_one.cwiseQuotient(mean.cwiseMax(1e-300)).maxCoeff();
  const auto count = static_cast<double>(points.size());
  return count * std::max(static_cast<double>(kFewestHits), needed / count);
}

double worst_mode(const Eigen::VectorXd& at_one, const Eigen::MatrixXd& squared,
                  const std::vector<Index>& points) {
  const Eigen::VectorXd mean = squared(points, Eigen::all).colwise().mean().transpose();
  return at_one.cwiseQuotient(mean.cwiseMax(1e-300)).maxCoeff();
}

Index best_addition(const Eigen::VectorXd& at_one, const Eigen::MatrixXd& squared,
                    std::vector<Index> points) {
  points.push_back(0);
  Index best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (Index i = 0; i < squared.rows(); ++i) {
    points.back() = i;
    const double needed = worst_mode(at_one, squared, points);
    if (needed < least) {
      least = needed;
      best = i;
    }
  }
  return best;
}

// @param squared  n×m: r² of the modes that can be reached
std::vector<Index> chosen_points(const Eigen::VectorXd& at_one, const Eigen::MatrixXd& squared) {
  std::vector<Index> points{best_addition(at_one, squared, {})};
  while (std::ssize(points) < kMostPoints) {
    auto more = points;
    more.push_back(best_addition(at_one, squared, points));
    for (std::size_t i = 0; i < more.size(); ++i) {  // exchange
      auto others = more;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
      more[i] = best_addition(at_one, squared, others);
    }
    if (blows_needed(at_one, squared, more) >
        kWorthAPoint * blows_needed(at_one, squared, points)) {
      break;
    }
    points = more;
  }
  return points;
}

// The model between the sensors and the chosen points, with the window's decay.
modal::ReducedModel at_points(const DesignModel& model, const Eigen::MatrixXd& candidates,
                              const std::vector<Index>& modes, const HammerDesign& design) {
  const auto p = static_cast<Index>(model.kinds.size());
  auto result = with_modes(model.model, modes);
  result.output_shapes = Eigen::MatrixXd(result.output_shapes.topRows(p));
  result.input_shapes = candidates(design.points, modes).transpose();
  result.residual.setZero(p, static_cast<Index>(design.points.size()));
  if (design.exponential_s > 0.0) {
    for (Index k = 0; k < result.mode_count(); ++k) {
      if (result.frequency_hz(k) <= 0.0) continue;
      result.damping_ratio(k) += 1.0 / (design.exponential_s * kTwoPi * result.frequency_hz(k));
    }
  }
  return result;
}

Eigen::MatrixXd variance_of(const DesignModel& model, const Blow& record, Index points) {
  const Eigen::MatrixXd one =
      record.noise.cwiseQuotient(kind_power(model.kinds, record.hz)).array().colwise() /
      record.power.array();
  return one.replicate(1, points);
}

void set_hits(const HammerPlan& plan, HammerDesign& design) {
  const auto points = static_cast<double>(design.points.size());
  const double each = points * (design.record_s + plan.pause_s);
  const double most = std::max(static_cast<double>(kFewestHits), std::floor(plan.longest_s / each));
  double hits = static_cast<double>(kFewestHits);
  std::vector<double> needed;
  for (const auto& mode : design.modes) {
    needed.push_back(std::ceil(averages_needed(mode, plan.frequency_std_hz, plan.damping_std)));
    if (needed.back() <= most) hits = std::max(hits, needed.back());
  }
  design.hits = static_cast<Index>(hits);
  design.duration_s = hits * each;
  for (std::size_t i = 0; i < design.modes.size(); ++i) {
    auto& mode = design.modes[i];
    mode.reached = needed[i] <= most;
    mode.seconds_needed = needed[i] * each;
    mode.frequency_std_hz /= std::sqrt(hits);
    mode.damping_std /= std::sqrt(hits);
    if (mode.reached) continue;
    if (mode.drive < kHardlyMoves)
      mode.why = "no point that can be hit moves it";
    else if (mode.sight < kHardlyMoves)
      mode.why = "no sensor sees it";
    else if (!std::isfinite(needed[i]))
      mode.why = "it stays below the noise";
    else
      mode.why = fmt::format("it needs {:.3g} blows at each point", needed[i]);
  }
}

// The modes in the band that 100 times the longest test would reach at their best point.
std::vector<Index> within_reach(const Eigen::VectorXd& at_one, const Eigen::MatrixXd& squared,
                                double most) {
  std::vector<Index> modes;
  for (Index k = 0; k < at_one.size(); ++k) {
    if (at_one(k) / std::max(squared.col(k).maxCoeff(), 1e-300) < most) modes.push_back(k);
  }
  return modes;
}

std::vector<ExpectedMode> modes_at(const DesignModel& model, const Eigen::MatrixXd& candidates,
                                   const std::vector<Index>& band,
                                   const std::vector<Index>& points) {
  std::vector<ExpectedMode> modes;
  for (const auto k : band) {
    const double largest = std::max(model.largest(k), 1e-300);
    const auto seen = model.model.output_shapes.col(k).head(std::ssize(model.kinds));
    modes.push_back({.mode = k,
                     .frequency_hz = model.model.frequency_hz(k),
                     .damping_ratio = model.model.damping_ratio(k),
                     .drive = candidates(points, k).cwiseAbs().maxCoeff() / largest,
                     .sight = seen.cwiseAbs().maxCoeff() / largest,
                     .why = ""});
  }
  return modes;
}

// Deviations after one blow at each point.
void set_bounds(const DesignModel& model, const modal::ReducedModel& there, const Blow& record,
                const std::vector<Index>& reachable, HammerDesign& design) {
  if (reachable.empty()) return;
  const auto fit = expected_fit(there, record.hz, variance_of(model, record, there.input_count()));
  for (std::size_t i = 0; i < reachable.size(); ++i) {
    auto& mode = design.modes[static_cast<std::size_t>(reachable[i])];
    const auto at = fit.model.rigid_count + static_cast<Index>(i);
    mode.frequency_std_hz = fit.frequency_std_hz(at);
    mode.damping_std = fit.damping_std(at) / mode.damping_ratio;
  }
}

}  // namespace

HammerDesign hammer_design(const DesignModel& stated, const Eigen::MatrixXd& candidates,
                           const HammerPlan& plan) {
  check(stated, candidates, plan);
  DesignModel model = stated;
  model.model = with_dashpots_as_ratios(stated.model);
  const auto band = modes_in_band(model.model, lines_plan(plan));
  require(!band.empty(),
          fmt::format("hammer design: no flexible mode between {:.6g} and {:.6g} Hz; expected "
                      "another band or more modes",
                      plan.low_hz, plan.high_hz));
  HammerDesign design;
  set_record(model.model, band, plan, design);
  const auto record = blow_of(plan, design);
  const auto at_one = blows_at_one(model, plan, record, band);
  const Eigen::MatrixXd squared = candidates(Eigen::all, band).cwiseAbs2();
  const auto reachable = within_reach(at_one, squared, 100.0 * plan.longest_s / design.record_s);
  design.points = {0};
  if (!reachable.empty()) {
    design.points = chosen_points(at_one(reachable), squared(Eigen::all, reachable));
  }
  design.modes = modes_at(model, candidates, band, design.points);
  std::vector<Index> fitted(static_cast<std::size_t>(model.model.rigid_count));
  std::iota(fitted.begin(), fitted.end(), Index{0});
  for (const auto k : reachable) fitted.push_back(band[static_cast<std::size_t>(k)]);
  const auto there = at_points(model, candidates, fitted, design);
  set_bounds(model, there, record, reachable, design);
  set_hits(plan, design);
  design.coherence = expected_coherence(
      record.hz, modal::frf(there, record.hz).value, kind_power(model.kinds, record.hz),
      record.power.replicate(1, there.input_count()), record.noise);
  return design;
}

}  // namespace chladni::identification
