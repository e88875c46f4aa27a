// What responses tell of small changes when the tolerances are not known.
#pragma once

#include <Eigen/Core>

#include "diagnosis/fit/fit.h"

namespace chladni::diagnosis {

/// What tolerances leave of what the responses tell, to first order about the simulation as it is:
/// with whitened slopes g of coordinates and J of deviations η ~ N(0, 1), the information
/// F = gᵀ (1 + J Jᵀ)⁻¹ g.
class Information {
 public:
  /// @param slopes  what the slopes are weighted as: the problem's lines, perhaps other weights
  /// Cost: a slope per deviation, N (deviations)².
  Information(const Problem& problem, const Observed& slopes);
  /// About a fit, its causes' coordinates as free as their priors are wide.
  Information(const Problem& problem, const Fit& about);
  /// @param slopes  N×d, weighted
  /// @return d×d. Cost: N d (deviations + d)
  [[nodiscard]] Eigen::MatrixXd of(const Eigen::MatrixXd& slopes) const;

  /// Of each slope by itself: gᵀ(1 + J Jᵀ)⁻¹(r + J η), r what is left at η, and its F. Where η is
  /// the most probable one the first is gᵀr; else, as of other lines, it is as if it were.
  struct Score {
    Eigen::VectorXd score, information;  ///< d
  };
  /// @param left  N: of the fit that this is about, weighted as the slopes
  [[nodiscard]] Score scored(const Eigen::MatrixXd& slopes, const Eigen::VectorXd& left) const;

 private:
  void take(const Eigen::MatrixXd& jacobian);
  /// L⁻¹ Jᵀ g.
  [[nodiscard]] Eigen::MatrixXd taken(const Eigen::MatrixXd& slopes) const;

  Eigen::VectorXd rows_;               ///< N: the problem's weights over those of the slopes
  Eigen::VectorXd eta_;                ///< n: where the deviations stand
  Eigen::MatrixXd jacobian_, factor_;  ///< Jᵀ, n×N; n×n: of JᵀJ + 1, lower
};

/// Of a prior's coordinate, as a normal deviation; of a place: √(area / 2π) each way, so that the
/// density of a normal prior in the middle is one over the area.
[[nodiscard]] double prior_width(const Structure& structure, const Parameter& parameter);

}  // namespace chladni::diagnosis
