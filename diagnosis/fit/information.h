// Information of the responses on small changes when the tolerances are unknown.
#pragma once

#include <Eigen/Core>

#include "diagnosis/fit/fit.h"

namespace chladni::diagnosis {

/// Information that the responses keep after the tolerances are marginalised, to first order about
/// the simulation. With whitened slopes g of the coordinates and J of the deviations η ~ N(0, 1),
/// it is F = gᵀ (1 + J Jᵀ)⁻¹ g.
class Information {
 public:
  /// @param slopes  gives the weights of the slopes: the problem's lines, perhaps other weights
  /// Cost: a slope per deviation, N (deviations)².
  Information(const Problem& problem, const Observed& slopes);
  /// About a fit. The coordinates of its causes are also free, with the widths of their priors.
  Information(const Problem& problem, const Fit& about);
  /// @param slopes  N×d, weighted
  /// @return d×d. Cost: N d (deviations + d)
  [[nodiscard]] Eigen::MatrixXd of(const Eigen::MatrixXd& slopes) const;

  /// Score test of each slope by itself: gᵀ(1 + J Jᵀ)⁻¹(r + J η), with r the residual at η, and its
  /// F. If η is the most probable one, the score is gᵀr. On other lines the formula is still used.
  struct Score {
    Eigen::VectorXd score, information;  ///< d
  };
  /// @param left  N: residual of the fit that this is about, weighted as the slopes
  [[nodiscard]] Score scored(const Eigen::MatrixXd& slopes, const Eigen::VectorXd& left) const;

 private:
  void take(const Eigen::MatrixXd& jacobian);
  /// L⁻¹ Jᵀ g.
  [[nodiscard]] Eigen::MatrixXd taken(const Eigen::MatrixXd& slopes) const;

  Eigen::VectorXd rows_;               ///< N: the problem's weights divided by those of the slopes
  Eigen::VectorXd eta_;                ///< n: values of the deviations
  Eigen::MatrixXd jacobian_, factor_;  ///< Jᵀ, n×N; n×n: of JᵀJ + 1, lower
};

/// Variance of the responses by the tolerances about a fit: Σ |d value / d eta|² over the
/// deviations, K×pq [m²/N²]; 0 where not measured.
/// @param now  the responses of the fit
/// Cost: a slope per deviation
[[nodiscard]] Eigen::MatrixXd tolerated_variance(const Problem& problem, const Fit& fit,
                                                 const Solved& now);

/// Width of the prior of a coordinate, as a standard deviation. For a place: √(area / 2π) in each
/// direction, longer along the longer side and shorter along the other in the ratio of the sides,
/// so that the density at the centre of a normal prior is 1 / area.
[[nodiscard]] double prior_width(const Structure& structure, const Parameter& parameter);

}  // namespace chladni::diagnosis
