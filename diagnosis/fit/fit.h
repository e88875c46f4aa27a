// Most probable sizes of supposed causes, together with the tolerances, and how well they explain
// the data.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "diagnosis/constants.h"
#include "diagnosis/effect.h"
#include "diagnosis/fit/deviations.h"
#include "diagnosis/fit/responses.h"
#include "diagnosis/observed.h"

namespace chladni::diagnosis {

/// The part that all fits of a diagnosis share.
struct Problem {
  const Structure& structure;
  const Observed& observed;
  const std::vector<Deviation>& deviations;
  /// Relative model-form error of another mesh or solver, for effects that depend on the mode
  /// shapes. It is added to Effect::error, for causes with such an error.
  double solver_error = 0.0;
};

/// Total error of a cause: Effect::error and the problem's solver_error, squares added. 0 if the
/// effect of the cause does not depend on the mode shapes.
[[nodiscard]] double error_of(const Problem& problem, const Supposed& cause);

/// z that a loss of ln likelihood adds for this many numbers, and the inverse.
[[nodiscard]] inline double excess_of(double lost, double numbers) {
  return 2.0 * lost / std::sqrt(2.0 * numbers);
}
[[nodiscard]] inline double lost_by(double excess, double numbers) {
  return 0.5 * excess * std::sqrt(2.0 * numbers);
}

/// Causes at their most probable sizes (posterior mode).
struct Fit {
  std::vector<Supposed> causes;
  Eigen::VectorXd eta;  ///< values of the deviations
  double chi_square = 0.0;
  double objective = 0.0;      ///< ½χ² + ½ηᵀη − ln π(x)
  double log_evidence = 0.0;   ///< ln ∫ likelihood × prior, Laplace; without (2π)^(-N/2) Π w
  Eigen::MatrixXd covariance;  ///< of all x, cause by cause, then of eta
  int iterations = 0;
  /// Fall of the objective by one more step, if it were quadratic; 0 if the fit was given up.
  double promise = 0.0;
  bool converged = false;  ///< `promise` is below Constants::nothing_more
  std::vector<Fit> less;   ///< fits without each cause in turn; empty: not known

  [[nodiscard]] Eigen::Index coordinate_count() const;  ///< over all causes
  /// Upper estimate of the evidence of a fit that has not converged: evidence plus promise. The
  /// promise counts up to Constants::promise_at_most.
  [[nodiscard]] double evidence_at_best() const;
  /// Penalised misfit χ² + ηᵀη: stretched tolerances count as misfit.
  [[nodiscard]] double strained() const { return chi_square + eta.squaredNorm(); }
  /// z = (χ² − N + parameters) / sqrt(2N).
  [[nodiscard]] double excess(double numbers) const;
};

/// True if both have the same causes and choices, at places that are one (Constants::same_place).
[[nodiscard]] bool alike(const Structure& structure, const Fit& a, const Fit& b);

/// The fit with its first `count` deviations; added ones are 0.
[[nodiscard]] Fit with_deviations(Fit fit, std::size_t count);

struct FitLimits {
  int iterations = kConstants.fit_iterations;
  /// The fit stops when the objective, the logarithm of a probability, changes by less.
  double tolerance = kConstants.fit_tolerance;
  /// The fit stops if the remaining iterations, each as good as the last, cannot reach this
  /// objective.
  double bar = HUGE_VAL;
  /// This coordinate, numbered as in Fit::covariance, stays as it is. Evidence and covariance are
  /// then not those of a mode.
  std::optional<Eigen::Index> held = std::nullopt;
};

/// Minimum of the objective by Levenberg and Marquardt in all coordinates, with slopes from
/// diagnosis::slope. The fit starts at `start.causes` and `start.eta`. Evidence, covariance and
/// promise belong to the end point. If the last step lowered the objective by less than
/// Constants::small_fall, they are taken at the point before this step. Cost: per iteration one
/// solve of all lines, a slope per coordinate, N (coordinates)².
/// @throws NumericalFailure  the start is impossible, or nothing determines the fit
[[nodiscard]] Fit fitted(const Problem& problem, const Fit& start, const FitLimits& limits = {});
/// The same; none where it fails.
[[nodiscard]] std::optional<Fit> possible_fit(const Problem& problem, const Fit& start,
                                              const FitLimits& limits = {});

}  // namespace chladni::diagnosis
