// The most probable sizes of supposed causes together with the tolerances, and how well that
// explains the data.
#pragma once

#include <cmath>
#include <vector>

#include "diagnosis/effect.h"
#include "diagnosis/fit/deviations.h"
#include "diagnosis/fit/responses.h"
#include "diagnosis/observed.h"

namespace chladni::diagnosis {

/// What every fit of a diagnosis shares.
struct Problem {
  const Structure& structure;
  const Observed& observed;
  const std::vector<Deviation>& deviations;
  /// How far off, relative, another mesh or solver finds what a cause does by way of the body's
  /// shapes; beside Effect::error, of causes that have one.
  double solver_error = 0.0;
};

/// Effect::error and the problem's solver_error of a cause together, squares added; 0 where it
/// does what it does whatever the shapes are.
[[nodiscard]] double error_of(const Problem& problem, const Supposed& cause);

/// The structure with its deviations (each in units of its tolerance), then the causes in order.
[[nodiscard]] State state_of(const Problem& problem, const std::vector<Supposed>& causes,
                             const Eigen::VectorXd& eta);

/// Where more than this part of the misfit is left, what was named does not explain much of it.
inline constexpr double kLeftAtMost = 0.2;

/// z that a loss of ln likelihood adds among so many numbers, and back.
[[nodiscard]] inline double excess_of(double lost, double numbers) {
  return 2.0 * lost / std::sqrt(2.0 * numbers);
}
[[nodiscard]] inline double lost_by(double excess, double numbers) {
  return 0.5 * excess * std::sqrt(2.0 * numbers);
}

/// ln of a posterior density may be so much behind that of a fit, and its evidence before it.
inline constexpr double kOccamMargin = 60.0;

/// Causes at their most probable sizes.
struct Fit {
  std::vector<Supposed> causes;
  Eigen::VectorXd eta;  ///< of the deviations
  double chi_square = 0.0;
  double objective = 0.0;      ///< ½χ² + ½ηᵀη − ln π(x)
  double log_evidence = 0.0;   ///< ln ∫ likelihood × prior, Laplace; less (2π)^(-N/2) Π w
  Eigen::MatrixXd covariance;  ///< of all x, cause by cause, then of eta
  int iterations = 0;
  /// By which one more step would lower the objective, were it quadratic; 0 where it was given up.
  double promise = 0.0;
  bool converged = false;  ///< that is less than would matter
  std::vector<Fit> less;   ///< without each cause in turn, fitted again; or none, not known

  [[nodiscard]] Eigen::Index coordinate_count() const;  ///< of all causes
  /// The evidence that it may have where it has not converged: with its promise, up to 8, beyond
  /// which a quadratic is no longer believed.
  [[nodiscard]] double evidence_at_best() const;
  /// χ² + ηᵀη: stretched tolerances count as misfit.
  [[nodiscard]] double strained() const { return chi_square + eta.squaredNorm(); }
  /// z = (χ² − N + parameters) / sqrt(2N).
  [[nodiscard]] double excess(double numbers) const;
};

/// Same causes with the same choices, places within a twentieth of the surface's size.
[[nodiscard]] bool alike(const Structure& structure, const Fit& a, const Fit& b);

/// The fit with `count` deviations: those that it lacks at rest.
[[nodiscard]] Fit with_deviations(Fit fit, std::size_t count);

struct FitLimits {
  int iterations = 30;
  double tolerance = 0.05;  ///< of the objective: it is a logarithm of a probability
  /// Given up where the iterations left, each worth the last, would not bring the objective here.
  double bar = HUGE_VAL;
};

/// A fit that promises more than this, in ln of a probability, has not converged.
inline constexpr double kNothingMore = 0.5;

/// The objective's minimum by Levenberg and Marquardt in all coordinates; slopes by
/// diagnosis::slope. `start.causes` and `start.eta` are where it begins. Evidence, covariance and
/// promise are those of the place where it ends, up to a step that promised a tenth or less.
/// Cost: per iteration one solve of all lines, a slope per coordinate, N (coordinates)².
[[nodiscard]] Fit fitted(const Problem& problem, const Fit& start, const FitLimits& limits = {});

/// d value / d x of each coordinate in turn, weighted: N × coordinates; causes, then deviations.
[[nodiscard]] Eigen::MatrixXd sensitivities(const Problem& problem,
                                            const std::vector<Supposed>& causes,
                                            const Eigen::VectorXd& eta, const Solved& now);

}  // namespace chladni::diagnosis
