// One mode (or a block) of gain_match: scales both sides alike.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace chladni::identification {

/// The pairs that count for one mode: L_c = α² ratio_c R_c.
struct Ties {
  std::vector<Eigen::Index> outputs, inputs;
  Eigen::VectorXd ratio, ratio_std;

  [[nodiscard]] Eigen::Index count() const { return ratio.size(); }
};

/// A mode as the fit gives it: x = (L, R, ratios of the ties), with the covariance C of L and R.
struct TwoSides {
  Eigen::VectorXd outputs, inputs;  ///< p, q
  Eigen::MatrixXd covariance;       ///< (p+q) squared; 0 where it is not known
  Ties ties;
};

/// The mode with one scale for both sides.
struct OneScale {
  Eigen::VectorXd outputs, inputs;  ///< φ at the sensors and at the actuators, as in the model
  Eigen::VectorXd at_inputs;        ///< φ at the actuators as rows of the output matrix
  double log_alpha = 0.0;
  double chi_square = 0.0;
};

/// (5.5). @pre there are ties
[[nodiscard]] OneScale scaled_by_thesis(const TwoSides& mode);

/// The most likely result for the covariance, under L_c = α² ratio_c R_c. It is (5.5) if the
/// covariance of the gaps is singular.
[[nodiscard]] OneScale scaled_by_ties(const TwoSides& mode);

/// φ = P c on both sides, with the most likely c and α.
/// @param bending  deviation from such a motion, relative to the shape's rms
/// @throws NumericalFailure  the places do not determine c and α
[[nodiscard]] OneScale scaled_by_motion(const TwoSides& mode, const Eigen::MatrixXd& outputs,
                                        const Eigen::MatrixXd& inputs, double bending);

/// 5.2.6: α by (5.5); the values at the actuators are extrapolated from the sensors.
[[nodiscard]] OneScale extrapolated_from_sensors(const TwoSides& mode,
                                                 const Eigen::MatrixXd& outputs,
                                                 const Eigen::MatrixXd& inputs);

/// T such that L T and T⁻¹ R agree at the ties, for a block L p×g, R g×q: L_c T Tᵀ = ratio R_cᵀ.
/// @throws NumericalFailure  the ties do not determine T Tᵀ, or it is not positive definite
[[nodiscard]] Eigen::MatrixXd block_transformation(const Eigen::MatrixXd& outputs,
                                                   const Eigen::MatrixXd& inputs, const Ties& ties);

/// F with F Fᵀ = C: one column for each uncertain direction.
[[nodiscard]] Eigen::MatrixXd covariance_factor(const Eigen::MatrixXd& covariance);

/// Factor of the covariance of value(x), by differences along the columns of `factor`, the factor
/// of x's covariance. Infinite if value() fails on one side.
[[nodiscard]] Eigen::MatrixXd propagated_factor(
    const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& value, const Eigen::VectorXd& x,
    const Eigen::MatrixXd& factor);

/// The standard deviations of value(x): norms of the rows of that factor.
[[nodiscard]] Eigen::VectorXd propagated(
    const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& value, const Eigen::VectorXd& x,
    const Eigen::MatrixXd& factor);

}  // namespace chladni::identification
