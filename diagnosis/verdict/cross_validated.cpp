#include "diagnosis/verdict/cross_validated.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/index.h"
#include "base/interrupt.h"
#include "dense/algebra.h"
#include "dense/blas.h"
#include "diagnosis/constants.h"
#include "diagnosis/fit/sensitivities.h"
#include "diagnosis/search/quadratic.h"
#include "diagnosis/search/simpler.h"
#include "diagnosis/verdict/held_out_parts.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Fit quickly_fitted(const Problem& problem, const Fit& start) {
  return fitted(problem, start, {.iterations = kConstants.quick_iterations});
}

using Causes = std::vector<Supposed>;

// A fit to all data, and the fits to the data without each part; none where no fit is possible.
struct Trained {
  Fit whole;
  std::vector<std::optional<Fit>> rest;
};

Trained trained(const Problem& problem, const std::vector<DataPart>& parts, Fit whole) {
  Trained result{std::move(whole), {}};
  for (const auto& part : parts) {
    throw_if_interrupted();
    const Observed data = without(problem.observed, part);
    result.rest.push_back(
        possible_fit({problem.structure, data, problem.deviations, problem.solver_error},
                     result.whole, {.iterations = kConstants.quick_iterations}));
  }
  return result;
}

// True for each cause that the data without part f are evidence for, beside the other causes.
std::vector<bool> supported(const Trained& all, const std::vector<Trained>& less, std::size_t f) {
  std::vector<bool> is_supported(less.size(), false);
  for (std::size_t c = 0; c < less.size(); ++c) {
    if (!all.rest[f] || !less[c].rest[f]) continue;
    is_supported[c] = all.rest[f]->evidence_at_best() > less[c].rest[f]->evidence_at_best();
  }
  return is_supported;
}

// The supported causes of a fit that may lack cause `without`. The others are as `otherwise` has
// them, which has as many as the fit; or left out, if it is empty.
Causes kept(const std::optional<Fit>& fit, const std::vector<bool>& supported,
            std::optional<std::size_t> without, const Causes& otherwise) {
  Causes causes;
  std::size_t n = 0;
  for (std::size_t c = 0; c < supported.size(); ++c) {
    if (c == without) continue;
    if (supported[c] && fit) {
      causes.push_back(fit->causes[n]);
    } else if (!otherwise.empty()) {
      causes.push_back(otherwise[n]);
    }
    ++n;
  }
  return causes;
}

// A part of the data with the slopes of a fit to all, by which the deviations are sought.
struct PartSlopes {
  std::vector<Index> rows;
  MatrixXd slope;  // of the rows, by the deviations
  MatrixXd gram;   // slopeᵀ slope
};

PartSlopes slopes_of(const Problem& problem, const DataPart& part, const MatrixXd& slopes,
                     Index deviations) {
  PartSlopes result;
  result.rows = rows_of(problem.observed, part);
  result.slope = slopes(result.rows, Eigen::lastN(deviations));
  result.gram = MatrixXd::Zero(deviations, deviations);
  dense::add_gram(result.slope, result.gram);
  return result;
}

// ½(χ² + ηᵀη) of a part, its residual, and the deviations.
struct PartPoint {
  double misfit = HUGE_VAL;
  VectorXd error, eta;
};

// None where the state is impossible.
std::optional<PartPoint> part_point(const Problem& problem, const Causes& causes,
                                    const PartSlopes& part, const VectorXd& eta) {
  try {
    const State state = state_of(problem, causes, eta);
    const VectorXd all = residual(problem.observed, responses(state, problem.observed.omega));
    PartPoint point{0.0, all(part.rows), eta};
    point.misfit = 0.5 * point.error.squaredNorm() + 0.5 * eta.squaredNorm();
    return point;
  } catch (const NumericalFailure&) {
    return std::nullopt;
  }
}

// The deviations after a step by the slopes.
VectorXd stepped(const PartSlopes& part, const PartPoint& from, double lambda) {
  Quadratic quadratic{from.eta - part.slope.transpose() * from.error,
                      part.gram.selfadjointView<Eigen::Lower>()};
  quadratic.curvature.diagonal().array() += 1.0;
  return from.eta + quadratic.step(lambda);
}

// Least ½(χ² + ηᵀη) of a part with these causes, by steps from eta that lower it; infinite where
// they are impossible beside eta.
double least_misfit(const Problem& problem, const Causes& causes, const PartSlopes& part,
                    const VectorXd& eta) {
  auto best = part_point(problem, causes, part, eta);
  if (!best) return HUGE_VAL;
  double lambda = 0.0;
  for (int step = 0; step < kConstants.part_steps; ++step) {
    auto next = part_point(problem, causes, part, stepped(part, *best, lambda));
    if (!next || !(next->misfit < best->misfit)) {
      lambda = std::max(0.1, 10.0 * lambda);
      continue;
    }
    const double fall = best->misfit - next->misfit;
    best = std::move(next);
    if (fall < kConstants.nothing_more) break;
  }
  return best->misfit;
}

// ½(χ² + ηᵀη) of each part with its own causes, where the deviations suit it best. They go with the
// causes, so they are sought from those of all data and from those of the rest.
std::vector<double> misfits(const Problem& problem, const std::vector<DataPart>& parts,
                            const Trained& fits, const std::vector<Causes>& causes) {
  const Fit& fit = fits.whole;
  const State state = state_of(problem, fit.causes, fit.eta);
  const Solved now = solved(state, Body(state, problem.observed.omega));
  const MatrixXd slopes = sensitivities(problem, fit.causes, fit.eta, now);
  std::vector<double> misfit;
  for (std::size_t f = 0; f < parts.size(); ++f) {
    const auto part = slopes_of(problem, parts[f], slopes, fit.eta.size());
    misfit.push_back(least_misfit(problem, causes[f], part, fit.eta));
    if (f >= fits.rest.size() || !fits.rest[f]) continue;
    misfit.back() =
        std::min(misfit.back(), least_misfit(problem, causes[f], part, fits.rest[f]->eta));
  }
  return misfit;
}

// Σ |G − Ĝ|² over what was measured.
double squared_error(const State& state, const Observed& data) {
  const Eigen::MatrixXcd value = responses(state, data.omega);
  return (data.weight.array() > 0.0).select((data.value - value).cwiseAbs2().array(), 0.0).sum();
}

// The constants as a fit has them, with all other deviations at 0.
VectorXd constants_alone(const Problem& problem, const VectorXd& eta) {
  VectorXd alone = VectorXd::Zero(std::ssize(problem.deviations));
  for (Eigen::Index i = 0; i < eta.size(); ++i) {
    if (problem.deviations[at(i)].is_constant) alone(i) = eta(i);
  }
  return alone;
}

// The same with causes and constants of a fit; none where they are impossible.
std::optional<double> error_with(const Problem& problem, const Observed& data, const Causes& causes,
                                 const Fit& fit) {
  try {
    return squared_error(state_of(problem, causes, constants_alone(problem, fit.eta)), data);
  } catch (const NumericalFailure&) {
    return std::nullopt;
  }
}

// Errors of the study as it is, and with causes and constants of a fit that did not see the data;
// none: it failed.
PredictionErrors errors_of(const Problem& problem, const Observed& data,
                           const std::vector<Supposed>& causes, const std::optional<Fit>& fit) {
  const Eigen::ArrayXXd weight2 = data.weight.array().square();
  PredictionErrors errors;
  errors.before = squared_error(state_of(problem.structure), data);
  errors.after = errors.before;
  if (fit) errors.after = error_with(problem, data, causes, *fit).value_or(errors.before);
  errors.size = (weight2 > 0.0).select(data.value.cwiseAbs2().array(), 0.0).sum();
  errors.noise = (weight2 > 0.0).select(2.0 / weight2.max(1e-300), 0.0).sum();
  return errors;
}

// The causes that predict each part.
std::vector<Causes> predicting(const Trained& fits, const std::vector<std::vector<bool>>& used) {
  std::vector<Causes> causes;
  for (std::size_t f = 0; f < used.size(); ++f) {
    causes.push_back(kept(fits.rest[f], used[f], {}, {}));
  }
  return causes;
}

// The causes by which one of them is judged, beside it or without it: those that the rest of the
// data does not support are as all data have them. A held-out sensor with another sign stays wrong
// without that cause, and nothing beside it makes its row right.
std::vector<Causes> judging(const Trained& fits, const std::vector<std::vector<bool>>& used,
                            std::optional<std::size_t> without = {}) {
  std::vector<Causes> causes;
  for (std::size_t f = 0; f < used.size(); ++f) {
    causes.push_back(kept(fits.rest[f], used[f], without, fits.whole.causes));
  }
  return causes;
}

// A part at which one of the two is impossible says nothing of them.
double gained(double before, double after) {
  return std::isfinite(before) && std::isfinite(after) ? before - after : 0.0;
}

std::vector<Trained> trained_without_each(const Problem& problem,
                                          const std::vector<DataPart>& parts, const Fit& whole,
                                          const Fit& nothing) {
  std::vector<Trained> less;
  for (std::size_t c = 0; c < whole.causes.size(); ++c) {
    less.push_back(trained(problem, parts, without(problem, whole, c, nothing)));
  }
  return less;
}

}  // namespace

PredictionErrors& PredictionErrors::operator+=(const PredictionErrors& more) {
  before += more.before;
  after += more.after;
  size += more.size;
  noise += more.noise;
  return *this;
}

double CrossValidation::gain(HeldOutPart::Kind kind, std::optional<std::size_t> which) const {
  double total = 0.0;
  for (const auto& part : parts) {
    if (part.kind == kind) total += which ? part.gain_of_cause[*which] : part.gain;
  }
  return total;
}

bool CrossValidation::pays(std::optional<std::size_t> which) const {
  const auto [less, more] =
      std::minmax({gain(HeldOutPart::Kind::sensors, which), gain(HeldOutPart::Kind::lines, which)});
  return less + more > 0.0 && less >= -kConstants.held_out_loss * more;
}

PredictionErrors CrossValidation::errors(HeldOutPart::Kind kind) const {
  PredictionErrors total;
  for (const auto& part : parts) {
    if (part.kind == kind) total += part.errors;
  }
  return total;
}

PredictionErrors CrossValidation::errors() const {
  auto total = errors(HeldOutPart::Kind::sensors);
  total += errors(HeldOutPart::Kind::lines);
  return total;
}

CrossValidation cross_validated(const Problem& problem, const Observed& all, const Fit& best,
                                const Fit& nothing) {
  const dense::OneBlasThread one_thread;
  const auto count = problem.deviations.size();
  const Fit none = quickly_fitted(problem, with_deviations(nothing, count));
  const auto parts = held_out_parts(problem.structure.outputs.names, all);
  const auto with = trained(problem, parts, quickly_fitted(problem, with_deviations(best, count)));
  const auto less = trained_without_each(problem, parts, with.whole, none);
  std::vector<std::vector<bool>> used;
  for (std::size_t f = 0; f < parts.size(); ++f) used.push_back(supported(with, less, f));
  const auto causes = predicting(with, used);
  const auto after = misfits(problem, parts, with, judging(with, used));
  const auto before = misfits(problem, parts, less.size() == 1 ? less.front() : Trained{none, {}},
                              std::vector<Causes>(parts.size()));
  std::vector<std::vector<double>> beside;
  for (std::size_t c = 0; c < less.size(); ++c) {
    beside.push_back(
        less.size() == 1 ? before : misfits(problem, parts, less[c], judging(less[c], used, c)));
  }
  CrossValidation result;
  for (std::size_t f = 0; f < parts.size(); ++f) {
    auto& part = result.parts.emplace_back(parts[f].told);
    // A part without a cause says nothing of it: the fits that never had the cause stretch the
    // deviations of its channel for it, the others do not.
    const bool whole = std::ranges::find(used[f], false) == used[f].end();
    part.gain = whole ? gained(before[f], after[f]) : 0.0;
    for (std::size_t c = 0; c < beside.size(); ++c) {
      part.gain_of_cause.push_back(used[f][c] ? gained(beside[c][f], after[f]) : 0.0);
    }
    part.errors = errors_of(problem, only(all, parts[f]), causes[f], with.rest[f]);
  }
  return result;
}

std::string doubt_what_does_not_pay(Diagnosis& diagnosis) {
  const auto& unseen = *diagnosis.cross_validation;
  auto& causes = diagnosis.best.causes;
  std::string names;
  for (std::size_t c = 0; c < causes.size(); ++c) {
    if (unseen.pays() && unseen.pays(c)) continue;
    causes[c].probability = std::min(causes[c].probability, kConstants.believed);
    names += (names.empty() ? "" : ", ") + causes[c].effect;
  }
  if (names.empty()) return "";
  diagnosis.best.probability = std::min(diagnosis.best.probability, kConstants.believed);
  diagnosis.verdict = unseen.pays() ? Verdict::partial : Verdict::unexplained;
  return fmt::format(
      "data that were held out are predicted no better with {} (fitted to the others): it has a "
      "probability of {} at most",
      names, kConstants.believed);
}

}  // namespace chladni::diagnosis
