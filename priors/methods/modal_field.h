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
  double beyond = 0.0;   ///< variance by modes beyond the r, in the values' unit²
};

/// A field of such shapes. Cost of `at`, per place and mode: r k multiplications, on all cores.
class ModalField : public ModeField {
 public:
  ModalField(std::vector<ShapeCoefficients> shapes, FitSummary summary);

  /// One per measured mode.
  [[nodiscard]] const std::vector<ShapeCoefficients>& shapes() const { return shapes_; }

 protected:
  /// @throws InvalidInput  places without the r modes
  [[nodiscard]] Field field_at(const Places& places) const override;

 private:
  void add_deviations(const Places& places, Eigen::Index first, Eigen::Index count,
                      Eigen::MatrixXd& deviation) const;

  std::vector<ShapeCoefficients> shapes_;
  Eigen::MatrixXd means_;               // r×m
  std::vector<Eigen::MatrixXd> roots_;  // r×r, lower: roots of the shapes' covariances
};

/// The posterior of one shape with c ~ N(0, a² R Rᵀ) and the most likely a².
/// @param root  r×k: R
struct FittedShape {
  ShapeCoefficients coefficients;
  double log_evidence = 0.0;
  double left_out_log_density = 0.0;  ///< Σ of the log density of each value given the others
  double misfit = 0.0;          ///< mean square of the left-out errors over their variance: about 1
  double expected_error = 0.0;  ///< of the shape's mean square over the surface, relative
  bool vanishes = false;
};
[[nodiscard]] FittedShape fitted_shape(const MeasuredShapes& measured, const ModalBasis& basis,
                                       Eigen::Index mode, const Eigen::MatrixXd& root, double noise,
                                       double beyond);

/// The field of a modal model (MeasuredShapes::sides) at few places, where all modes share one
/// scale (residual/one_scale.h). Cost: some thousand decompositions of s rows per mode.
[[nodiscard]] std::unique_ptr<ModeField> one_scale_field(const MeasuredShapes& measured,
                                                         const Simulation& simulation);

/// Summary of every modal method: parameters `misfit` and `expected_error`; notes on shapes that
/// the places cannot see.
[[nodiscard]] FitSummary modal_summary(const std::vector<FittedShape>& shapes);

}  // namespace chladni::priors
