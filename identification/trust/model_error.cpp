#include "identification/model_error.h"

#include <algorithm>
#include <cmath>

#include "identification/constants.h"

namespace chladni::identification {
Eigen::VectorXd remaining_model_error(const FitData& noise_only, const Eigen::MatrixXcd& fitted,
                                      double most) {
  const Eigen::ArrayXXd weight = noise_only.weight.array();
  // In deviations of the noise: the residual and the size of the response.
  const Eigen::ArrayXXd left = weight * (noise_only.value - fitted).cwiseAbs().array();
  const Eigen::ArrayXXd size = weight * fitted.cwiseAbs().array();
  const Eigen::ArrayXXd there = (weight > 0.0).cast<double>();
  const double per_number =
      2.0 * expected_cost(noise_only, 0).mean /
      static_cast<double>(std::max<Eigen::Index>(1, noise_only.measured_count()));
  // Σ (|e|² − σ²) over Σ |G|²; each response counts in units of its noise at the line.
  const Eigen::ArrayXd beyond = (left.square() - per_number * there).rowwise().sum();
  const Eigen::ArrayXd power = size.square().rowwise().sum();
  const Eigen::Index lines = noise_only.line_count();
  Eigen::VectorXd error(lines);
  for (Eigen::Index k = 0; k < lines; ++k) {
    const Eigen::Index first = std::max<Eigen::Index>(0, k - Constants::error_reach);
    const Eigen::Index count = std::min(lines, k + Constants::error_reach + 1) - first;
    const double sum = power.segment(first, count).sum();
    const double squared = sum > 0.0 ? beyond.segment(first, count).sum() / sum : 0.0;
    error(k) = std::min(most, std::sqrt(std::max(0.0, squared)));
  }
  return error;
}

FitData with_model_error(const FitData& noise_only, const Eigen::MatrixXcd& fitted,
                         const Eigen::VectorXd& model_error) {
  FitData data = noise_only;
  const Eigen::ArrayXXd off =
      (model_error.asDiagonal() * fitted.cwiseAbs()).array() * noise_only.weight.array();
  data.weight = noise_only.weight.array() / (1.0 + off.square()).sqrt();
  const Eigen::ArrayXXd share = off.square() / (1.0 + off.square());
  const double measured = 0.5 * static_cast<double>(data.measured_count());
  data.error_share = std::max(noise_only.error_share, share.sum() / std::max(1.0, measured));
  data.noise_known = noise_only.noise_known && model_error.isZero(0.0);
  return data;
}

}  // namespace chladni::identification
