// Mode fields of Gaussian processes that use only distances: all places have one direction.
#pragma once

#include <string>
#include <vector>

#include "priors/gaussian_process/gaussian_process.h"
#include "priors/interpolator.h"

namespace chladni::priors {

/// One shape: its process and its values.
struct EuclideanShape {
  GaussianProcess process;
  Eigen::VectorXd values;  ///< s
  double log_evidence = 0.0;
  double widening = 1.0;  ///< factor on the deviation, because few values determine the amplitude
};

/// The process of a shape with known noise; marginal likelihood gives its amplitude. The
/// uncertainty of the amplitude makes the distribution Student's; the deviation is that of
/// this distribution.
[[nodiscard]] EuclideanShape euclidean_shape(const MeasuredShapes& measured, Eigen::Index mode,
                                             const Kernel& kernel,
                                             const Eigen::VectorXd& parameters, const Trend& trend);

class EuclideanField : public ModeField {
 public:
  /// @param direction  unit, for all places
  EuclideanField(std::vector<EuclideanShape> shapes, const Eigen::RowVector3d& direction,
                 std::string method, FitSummary summary);

 private:
  /// @throws InvalidInput  a place has another direction
  [[nodiscard]] Field field_at(const Places& places) const override;

  std::vector<EuclideanShape> shapes_;
  Eigen::RowVector3d direction_;
  std::string method_;
};

/// The common direction of all places.
/// @throws InvalidInput  two differ by more than 1e-6
[[nodiscard]] Eigen::RowVector3d common_direction(const std::string& method, const Places& places);

/// The rigid trend of places in one direction; none if it would leave no data to learn from.
[[nodiscard]] Trend trend_of(const Places& places);

}  // namespace chladni::priors
