// The coordinates of a hypothesis in one vector, and their prior.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/modes/calibration/constants_held.h"
#include "diagnosis/modes/errors/levels.h"

namespace chladni::diagnosis {

/// The coordinates of all causes in one vector.
[[nodiscard]] Eigen::VectorXd coordinates(const std::vector<Supposed>& causes);
/// The causes with their coordinates moved by `step`.
[[nodiscard]] std::vector<Supposed> moved(std::vector<Supposed> causes,
                                          const Eigen::VectorXd& step);

/// The priors of the coordinates: centres and inverse variances.
struct CoordinatePrior {
  Eigen::VectorXd centre, precision, step;
  std::vector<bool> is_place;

  /// Slope of −ln prior; a place has none.
  [[nodiscard]] Eigen::VectorXd slope(const Eigen::VectorXd& x) const;
};

/// What is supposed in one hypothesis: the constants of the study, then causes.
/// @param x  one coordinate of each constant; empty: the study's
[[nodiscard]] std::vector<Supposed> supposed(const std::vector<HeldConstant>& constants,
                                             const Eigen::VectorXd& x,
                                             const std::vector<Supposed>& causes);
/// @param all  as `supposed` makes them
[[nodiscard]] CoordinatePrior prior_of(const Structure& structure,
                                       const std::vector<HeldConstant>& constants,
                                       const std::vector<Supposed>& all);
/// ln of its density, with that of places and choices.
[[nodiscard]] double log_prior(const Structure& structure,
                               const std::vector<HeldConstant>& constants,
                               const std::vector<Supposed>& all);

/// The errors with those of the sizes among what their blocks share, to first order: a size that
/// the prior draws to its centre takes away as much as it explains.
/// @param slope  N×n, of the errors in the coordinates, at x
[[nodiscard]] ModeErrors with_sizes(ModeErrors errors, const Eigen::MatrixXd& slope,
                                    const CoordinatePrior& prior, const Eigen::VectorXd& x);

}  // namespace chladni::diagnosis
