// How the covariance of modal errors changes with the sizes of a hypothesis.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/modes/errors/levels.h"

namespace chladni::diagnosis {

/// The covariance C_b of each block by itself, its part of the shared errors in it.
class CovarianceSlopes {
 public:
  /// @throws NumericalFailure  a covariance that is not positive
  CovarianceSlopes(const ModeErrors& here, const PerClass& levels);

  /// Number of entries: Σ n_b².
  [[nodiscard]] Eigen::Index count() const { return count_; }
  /// L_b⁻¹ (dC_b/dx) L_b⁻ᵀ with C_b = L_b L_bᵀ, all entries of all blocks. To first order,
  /// from the errors at a distance of `step`. The part of two coordinates in the information of
  /// the likelihood is half the product of their columns. Cost: Σ n_b³.
  /// @pre  as many numbers in each block as here
  [[nodiscard]] Eigen::VectorXd of(const ModeErrors& there, double step) const;

 private:
  PerClass levels_;
  std::vector<Eigen::MatrixXd> covariances_;
  std::vector<Eigen::MatrixXd> factors_;
  Eigen::Index count_ = 0;
};

}  // namespace chladni::diagnosis
