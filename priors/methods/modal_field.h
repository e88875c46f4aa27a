// Mode shapes as random sums of the simulation's modes.
#pragma once

#include <vector>

#include "priors/interpolator.h"
#include "priors/residual/residual_evidence.h"

namespace chladni::priors {

/// One shape: φ = Σ c_j ψ_j on r modes.
struct ShapeCoefficients {
  Eigen::VectorXd mean;  ///< r
  Eigen::MatrixXd root;  ///< r×k: F of the covariance F Fᵀ
  double beyond = 0.0;   ///< variance that modes beyond the r add anywhere, in the values' unit²
};

/// A field of such shapes. Cost of `at`, per place and mode: r k multiplications, on all cores.
class ModalField : public ModeField {
 public:
  ModalField(std::vector<ShapeCoefficients> shapes, FitSummary summary);

  /// @throws InvalidInput  places without the r modes
  [[nodiscard]] Field at(const Places& places) const override;

  /// One per measured mode.
  [[nodiscard]] const std::vector<ShapeCoefficients>& shapes() const { return shapes_; }

 private:
  void add_deviations(const Places& places, Eigen::Index first, Eigen::Index count,
                      Eigen::MatrixXd& deviation) const;

  std::vector<ShapeCoefficients> shapes_;
  Eigen::MatrixXd means_;               // r×m
  std::vector<Eigen::MatrixXd> roots_;  // r×r, lower: of the shapes' covariances
};

/// The coefficients of one shape with c ~ N(0, a² R Rᵀ), a² the likeliest, once it is measured.
/// @param root  r×k: R
struct FittedShape {
  ShapeCoefficients coefficients;
  double log_evidence = 0.0;
  double left_out_log_density = 0.0;  ///< of each value given the others, summed
  double misfit = 0.0;  ///< mean square of what the others predict, over its variance: about 1
  double expected_error = 0.0;  ///< of the shape's mean square over the surface, relative
  bool vanishes = false;
};
[[nodiscard]] FittedShape fitted_shape(const MeasuredShapes& measured, const ModalBasis& basis,
                                       Eigen::Index mode, const Eigen::MatrixXd& root, double noise,
                                       double beyond);

/// What every modal method says of its fit: parameters `amplitude`, `misfit`, `expected_error`;
/// notes on shapes that the places cannot see and on shapes that the prior does not expect.
[[nodiscard]] FitSummary modal_summary(const std::vector<FittedShape>& shapes);

}  // namespace chladni::priors
