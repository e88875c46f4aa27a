#include "identification/experiment_design.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/interrupt.h"
#include "base/turn.h"
#include "identification/experiment/amplitude_shape.h"
#include "identification/experiment/design_lines.h"
#include "identification/experiment/expected_fit.h"
#include "identification/experiment/expected_quality.h"
#include "recordings/fft.h"

namespace chladni::identification {
namespace {

constexpr int kCrestSteps = 100;
constexpr Eigen::Index kLongestTried = Eigen::Index{1}
                                       << 18U;  // whose crest factor is lowered to tell
constexpr double kSettled = 1e-4;  // part of the start that may be left when recording begins
constexpr Eigen::Index kLongestSettle = 10000;

void check(const DesignModel& model, const DesignPlan& plan) {
  modal::check(model.model);
  const auto p = static_cast<Eigen::Index>(model.kinds.size());
  require(p >= 1 && p <= model.model.output_count() && model.model.input_count() >= 1,
          "experiment design: expected a sensor and an actuator or more");
  require(std::isfinite(plan.force_limit_n) || std::isfinite(plan.stroke_limit_m),
          "experiment design: nothing limits the excitation; expected a limit of force, stroke or "
          "voltage");
  require(plan.sensor_noise.size() == p && plan.sensor_noise.allFinite() &&
              (plan.sensor_noise.minCoeff() > 0.0 || plan.noise_ratio > 0.0),
          "experiment design: the sensors have no noise, so any measurement is perfect; expected "
          "the rms of their noise");
  require(plan.high_hz > plan.low_hz && plan.high_hz < 0.5 / plan.sample_time_s,
          fmt::format("experiment design: the band is {:.6g} to {:.6g} Hz; expected it ascending "
                      "and below {:.6g} Hz, half the sampling frequency",
                      plan.low_hz, plan.high_hz, 0.5 / plan.sample_time_s));
}

// One plan per input with the shape of K×q powers |U|²; rms 1.
std::vector<recordings::MultisinePlan> multisines(const DesignPlan& plan, const DesignLines& lines,
                                                  const Eigen::MatrixXd& power,
                                                  const Eigen::VectorXd& rms,
                                                  int crest_iterations) {
  std::vector<recordings::MultisinePlan> result;
  for (Eigen::Index j = 0; j < power.cols(); ++j) {
    result.push_back({.period = lines.period,
                      .sample_time_s = plan.sample_time_s,
                      .low_hz = plan.low_hz,
                      .high_hz = plan.high_hz,
                      .lines = plan.lines,
                      .rms = rms(j),
                      .shape_hz = lines.hz,
                      .shape = power.col(j).cwiseSqrt(),
                      .crest_iterations = crest_iterations});
  }
  return result;
}

std::vector<recordings::ExperimentSet> drawn(const std::vector<recordings::MultisinePlan>& plans,
                                             const DesignPlan& plan, int count, unsigned seed) {
  Draw draw(seed);
  std::vector<recordings::ExperimentSet> sets;
  for (int r = 0; r < count; ++r) {
    throw_if_interrupted();
    sets.push_back(experiments(plans, plan.scheme, draw));
  }
  return sets;
}

// Peak displacements of all outputs in the steady state of one experiment.
Eigen::VectorXd peaks_of(const DesignModel& model, const DesignLines& lines,
                         const recordings::ExperimentSet& set, std::size_t e) {
  const Eigen::MatrixXcd force = recordings::fourier(set.inputs[e]);
  Eigen::MatrixXcd moved = Eigen::MatrixXcd::Zero(force.rows(), model.model.output_count());
  for (std::size_t k = 0; k < lines.index.size(); ++k) {
    moved.row(lines.index[k]) =
        (lines.response[k] * force.row(lines.index[k]).transpose()).transpose();
  }
  return recordings::inverse_fourier(moved, lines.period)
      .cwiseAbs()
      .colwise()
      .maxCoeff()
      .transpose();
}

// The rms of each force that keeps all limits, its margin taken off, and what limits it.
struct Levels {
  Eigen::VectorXd rms;     // q
  Eigen::VectorXd peak;    // q
  Eigen::VectorXd stroke;  // all outputs
  std::vector<bool> by_stroke;
};

Levels levels_of(const DesignModel& model, const DesignPlan& plan, const DesignLines& lines,
                 const std::vector<recordings::ExperimentSet>& unit) {
  const auto q = model.model.input_count();
  const double force_limit = plan.margin * plan.force_limit_n;
  const double stroke_limit = plan.margin * plan.stroke_limit_m;
  Eigen::VectorXd force_peak = Eigen::VectorXd::Zero(q);
  Eigen::MatrixXd stroke = Eigen::MatrixXd::Zero(model.model.output_count(), q);  // by experiment
  for (const auto& set : unit) {
    for (Eigen::Index e = 0; e < q; ++e) {
      const auto& inputs = set.inputs[static_cast<std::size_t>(e)];
      force_peak = force_peak.cwiseMax(inputs.cwiseAbs().colwise().maxCoeff().transpose());
      stroke.col(e) =
          stroke.col(e).cwiseMax(peaks_of(model, lines, set, static_cast<std::size_t>(e)));
    }
  }
  Levels levels{.rms = Eigen::VectorXd(q), .peak = {}, .stroke = {}, .by_stroke = {}};
  const bool together = plan.scheme == recordings::InputScheme::orthogonal;
  const double worst = force_peak.maxCoeff();
  for (Eigen::Index j = 0; j < q; ++j) {
    const double by_force = force_limit / (together ? worst : force_peak(j));
    const double by_stroke =
        stroke_limit / std::max(together ? stroke.maxCoeff() : stroke.col(j).maxCoeff(), 1e-300);
    levels.rms(j) = std::min(by_force, by_stroke);
    levels.by_stroke.push_back(by_stroke < by_force);
  }
  levels.peak = levels.rms.cwiseProduct(force_peak);
  levels.stroke = (stroke * levels.rms.asDiagonal()).rowwise().maxCoeff();
  return levels;
}

// |U|² of all experiments of a realisation at these rms: K×q.
Eigen::MatrixXd power_at(const DesignPlan& plan, const DesignLines& lines,
                         const Eigen::MatrixXd& shape, const Eigen::VectorXd& rms) {
  const auto samples = static_cast<double>(lines.period);
  const double times = excitations(plan, shape.cols());
  Eigen::MatrixXd power = shape;
  for (Eigen::Index j = 0; j < power.cols(); ++j) {
    const double wanted = samples * rms(j);
    power.col(j) *= times * 0.5 * wanted * wanted / shape.col(j).sum();
  }
  return power;
}

/// A spectrum within the limits.
struct Candidate {
  Eigen::MatrixXd shape;   // K×q, any scale
  Levels levels;           // of the first realisation
  Eigen::VectorXd needed;  // per mode in the band: averages of one period
};

Candidate candidate(const DesignModel& model, const DesignPlan& plan, const DesignLines& lines,
                    const ShapeProblem& problem, Eigen::MatrixXd shape, unsigned seed) {
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(shape.cols());
  const auto unit =
      drawn(multisines(plan, lines, shape, one, plan.crest_iterations), plan, 1, seed);
  Candidate result{
      .shape = std::move(shape), .levels = levels_of(model, plan, lines, unit), .needed = {}};
  result.needed =
      expected_variance(problem, power_at(plan, lines, result.shape, result.levels.rms));
  return result;
}

double worst_of(const Eigen::VectorXd& needed, const std::vector<Eigen::Index>& modes) {
  double worst = 0.0;
  for (const auto k : modes) worst = std::max(worst, needed(k));
  return worst;
}

// The power of each line in terms of the limits: of force, and of stroke at the worst output.
Eigen::MatrixXd cost_of(const DesignModel& model, const DesignPlan& plan, const DesignLines& lines,
                        bool with_stroke) {
  Eigen::MatrixXd cost = Eigen::MatrixXd::Ones(lines.hz.size(), model.model.input_count());
  if (std::isfinite(plan.force_limit_n)) cost /= plan.force_limit_n * plan.force_limit_n;
  if (!with_stroke || !std::isfinite(plan.stroke_limit_m)) return cost;
  if (!std::isfinite(plan.force_limit_n)) cost.setZero();
  for (Eigen::Index k = 0; k < cost.rows(); ++k) {
    const auto& response = lines.response[static_cast<std::size_t>(k)];
    cost.row(k) +=
        (response.cwiseAbs2() / (plan.stroke_limit_m * plan.stroke_limit_m)).colwise().maxCoeff();
  }
  return cost.cwiseMax(1e-12 * cost.maxCoeff());
}

// Even, shaped for the force, shaped for force and stroke: whichever needs the least time.
std::vector<Candidate> candidates(const DesignModel& model, const DesignPlan& plan,
                                  const DesignLines& lines, const ShapeProblem& problem,
                                  std::vector<Eigen::Index>& within_reach, unsigned seed) {
  const Eigen::MatrixXd even = Eigen::MatrixXd::Ones(lines.hz.size(), model.model.input_count());
  std::vector<Candidate> found;
  found.push_back(candidate(model, plan, lines, problem, even, seed));
  // What 100 times the longest experiment would not reach takes no part in the shape.
  const double most =
      100.0 * plan.longest_s / (static_cast<double>(lines.period) * plan.sample_time_s);
  ShapeProblem part = problem;
  for (Eigen::Index k = 0; k < problem.frequency_hz.size(); ++k) {
    if (found.front().needed(k) < most) within_reach.push_back(k);
  }
  if (within_reach.empty()) return found;
  part.frequency_hz = Eigen::VectorXd(problem.frequency_hz(within_reach));
  part.damping_ratio = Eigen::VectorXd(problem.damping_ratio(within_reach));
  part.sight = Eigen::MatrixXd(problem.sight(Eigen::all, within_reach));
  part.drive = Eigen::MatrixXd(problem.drive(within_reach, Eigen::all));
  for (const bool with_stroke : {false, true}) {
    found.push_back(candidate(model, plan, lines, problem,
                              best_power(part, cost_of(model, plan, lines, with_stroke)), seed));
  }
  return found;
}

ShapeProblem problem_of(const DesignModel& model, const DesignPlan& plan, const DesignLines& lines,
                        const Eigen::VectorXd& noise, const std::vector<Eigen::Index>& modes) {
  const auto p = static_cast<Eigen::Index>(model.kinds.size());
  const Eigen::MatrixXd seen =
      kind_power(model.kinds, lines.hz).cwiseQuotient(noise_power(model, plan, lines, noise));
  const Eigen::MatrixXd shapes = model.model.output_shapes(Eigen::seqN(0, p), modes);
  ShapeProblem problem{.line_hz = lines.hz,
                       .frequency_hz = model.model.frequency_hz(modes),
                       .damping_ratio = model.model.damping_ratio(modes),
                       .sight = seen * shapes.cwiseAbs2(),
                       .drive = model.model.input_shapes(modes, Eigen::all).cwiseAbs2(),
                       .frequency_std_hz = plan.frequency_std_hz,
                       .damping_std = plan.damping_std,
                       .simulation_error = plan.simulation_error};
  problem.sight = lines.hold.cwiseAbs2().asDiagonal() * problem.sight;
  return problem;
}

// Part of a mode's steady motion that is off at a time after the rise of a force that begins at 0,
// half a cosine: ∫ ṙ(s) e^{−σ(t − s)} ds.
double left_of_start(double decay, double rise_s, double time_s) {
  const double turn = std::numbers::pi / rise_s;
  return 0.5 * turn * turn * (std::exp(-decay * time_s) + std::exp(-decay * (time_s - rise_s))) /
         (decay * decay + turn * turn);
}

// The least decay of a damped mode above 0 Hz [1/s]; 1e300: there is none.
double slowest_decay(const modal::ReducedModel& model) {
  double slowest = 1e300;
  for (Eigen::Index k = model.rigid_count; k < model.mode_count(); ++k) {
    const double decay = kTwoPi * model.damping_ratio(k) * model.frequency_hz(k);
    if (decay > 0.0) slowest = std::min(slowest, decay);
  }
  return slowest;
}

// Periods until what is left of the start is small, at the slowest mode.
Eigen::Index settling(double slowest, double period_s, double rise_s) {
  const double periods = std::max(1.0, std::ceil(-std::log(kSettled) / (slowest * period_s)));
  const bool is_late = left_of_start(slowest, rise_s, periods * period_s) > kSettled;
  return static_cast<Eigen::Index>(
      std::min(periods + (is_late ? 1.0 : 0.0), static_cast<double>(kLongestSettle)));
}

// The force rises over half a period, or over a quarter where that saves a period.
void set_start(const modal::ReducedModel& model, ExperimentDesign& design) {
  const double slowest = slowest_decay(model);
  const double period = design.period_s();
  const auto slow = settling(slowest, period, 0.5 * period);
  const auto fast = settling(slowest, period, 0.25 * period);
  design.settle = std::min(slow, fast);
  design.ramp = design.period / (fast < slow ? 4 : 2);
  const double time = static_cast<double>(design.settle) * period;
  const double rise = static_cast<double>(design.ramp) * design.sample_time_s;
  if (const double left = left_of_start(slowest, rise, time); left > kSettled) {
    design.notes.push_back(
        fmt::format("after {} periods {:.2g} of the start is left of the slowest mode, whose "
                    "amplitude decays to 1/e in {:.3g} s",
                    design.settle, left, 1.0 / slowest));
  }
  for (Eigen::Index k = model.rigid_count; k < model.mode_count(); ++k) {
    if (model.damping_ratio(k) > 0.0) continue;
    design.notes.push_back(
        fmt::format("the mode at {:.4g} Hz has no damping: what the start leaves of it never "
                    "settles",
                    model.frequency_hz(k)));
  }
}

void set_signals(const DesignModel& model, const DesignPlan& plan, const DesignLines& lines,
                 const Candidate& best, unsigned seed, ExperimentDesign& design) {
  const auto q = model.model.input_count();
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(q);
  const auto plans = multisines(plan, lines, best.shape, one, plan.crest_iterations);
  design.realisations = drawn(plans, plan, plan.realisations, seed);
  const auto levels = levels_of(model, plan, lines, design.realisations);
  design.stroke_m = levels.stroke;
  for (auto& set : design.realisations) {
    for (auto& inputs : set.inputs) inputs *= levels.rms.asDiagonal();
    design.crest_factor = std::max(design.crest_factor, set.crest_factor);
  }
  design.amplitude.resize(lines.hz.size(), q);
  const auto power = power_at(plan, lines, best.shape, levels.rms);
  design.amplitude =
      (power / excitations(plan, q)).cwiseSqrt() * 2.0 / static_cast<double>(lines.period);
  for (Eigen::Index j = 0; j < q; ++j) {
    design.forces.push_back({.rms_n = levels.rms(j),
                             .peak_n = levels.peak(j),
                             .limited_by_stroke = levels.by_stroke[static_cast<std::size_t>(j)]});
  }
  const bool can_lower =
      plan.scheme == recordings::InputScheme::one_at_a_time || recordings::differ_in_sign_only(q);
  if (plan.crest_iterations == 0 && can_lower && lines.period <= kLongestTried) {
    design.low_crest_factor =
        drawn(multisines(plan, lines, best.shape, one, kCrestSteps), plan, 1, seed)
            .front()
            .crest_factor;
  }
}

// The noise of each sensor, from its ratio to the response of an even spectrum if it is stated so.
Eigen::VectorXd noise_of(const DesignModel& model, const DesignPlan& plan, const DesignLines& lines,
                         unsigned seed) {
  if (plan.noise_ratio <= 0.0) return plan.sensor_noise;
  const Eigen::MatrixXd even = Eigen::MatrixXd::Ones(lines.hz.size(), model.model.input_count());
  const auto unit =
      drawn(multisines(plan, lines, even, Eigen::VectorXd::Ones(even.cols()), 0), plan, 1, seed);
  const auto levels = levels_of(model, plan, lines, unit);
  const auto power = power_at(plan, lines, even, levels.rms);
  const auto kinds = kind_power(model.kinds, lines.hz);
  Eigen::VectorXd noise = Eigen::VectorXd::Zero(kinds.cols());
  for (Eigen::Index k = 0; k < kinds.rows(); ++k) {
    const Eigen::MatrixXd moved =
        lines.response[static_cast<std::size_t>(k)].topRows(kinds.cols()).cwiseAbs2();
    noise += kinds.row(k).transpose().cwiseProduct(moved * power.row(k).transpose());
  }
  const auto samples = static_cast<double>(lines.period);
  return plan.noise_ratio *
         (2.0 * noise / (samples * samples * static_cast<double>(even.cols()))).cwiseSqrt();
}

Eigen::VectorXd rms_of(const ExperimentDesign& design) {
  Eigen::VectorXd rms(std::ssize(design.forces));
  for (Eigen::Index j = 0; j < rms.size(); ++j) {
    rms(j) = design.forces[static_cast<std::size_t>(j)].rms_n;
  }
  return rms;
}

}  // namespace

ExperimentDesign experiment_design(const DesignModel& stated, const DesignPlan& plan, unsigned seed,
                                   const Progress& progress) {
  check(stated, plan);
  DesignModel model = stated;
  model.model = with_dashpots_as_ratios(stated.model);
  const auto modes = modes_in_band(model.model, plan);
  const auto period = period_for(model.model, plan);
  tell(progress, "responses of the simulation");
  const auto lines = design_lines(stated, plan, period, seed);
  const auto noise = noise_of(stated, plan, lines, seed);
  const auto problem = problem_of(model, plan, lines, noise, modes);
  tell(progress, "shaping the spectrum");
  std::vector<Eigen::Index> within_reach;
  const auto all = candidates(stated, plan, lines, problem, within_reach, seed);
  const auto best = std::ranges::min_element(
      all, {}, [&](const Candidate& one) { return worst_of(one.needed, within_reach); });
  ExperimentDesign design;
  design.period = period;
  design.sample_time_s = plan.sample_time_s;
  design.line_hz = lines.hz;
  design.spacing_hz = static_cast<double>(recordings::step_of(plan.lines)) / design.period_s();
  tell(progress, "drawing phases");
  set_signals(stated, plan, lines, *best, seed, design);
  const double of_one = design.period_s() * static_cast<double>(model.model.input_count());
  design.flat_seconds = worst_of(all.front().needed, within_reach) * of_one;
  design.shaped_seconds = worst_of(best->needed, within_reach) * of_one;
  set_start(model.model, design);
  tell(progress, "expected deviations");
  set_expected_quality({.model = model,
                        .plan = plan,
                        .lines = lines,
                        .power = power_at(plan, lines, best->shape, rms_of(design)),
                        .noise = noise_power(stated, plan, lines, noise),
                        .within_reach = within_reach},
                       design);
  return design;
}

Eigen::Index first_recorded(const ExperimentDesign& design) {
  return design.settle * design.period;
}

Eigen::MatrixXd sequence(const ExperimentDesign& design, const Eigen::MatrixXd& one_period) {
  require(one_period.rows() == design.period,
          fmt::format("sequence: a period of {} samples; expected {}", one_period.rows(),
                      design.period));
  const auto whole = design.period * (design.settle + design.periods);
  Eigen::MatrixXd signal(whole + design.ramp, one_period.cols());
  signal.topRows(whole) = one_period.replicate(design.settle + design.periods, 1);
  signal.bottomRows(design.ramp) = one_period.topRows(design.ramp);
  for (Eigen::Index n = 0; n < design.ramp; ++n) {
    const double part = (static_cast<double>(n) + 0.5) / static_cast<double>(design.ramp);
    const double rise = 0.5 - 0.5 * std::cos(std::numbers::pi * part);
    signal.row(n) *= rise;
    signal.row(whole + n) *= 1.0 - rise;
  }
  return signal;
}

}  // namespace chladni::identification
