#include <cmath>

#include "priors/gaussian_process/exponential.h"
#include "priors/kernels/radial.h"

namespace chladni::priors {
namespace {

void matern_5_2_column(const CoordinatesView& points, const Eigen::RowVector3d& other,
                       const Eigen::VectorXd& parameters, KernelColumn& column) {
  const auto scale = lengths(parameters, 0);
  const Eigen::ArrayXd s = scaled_square(points, other, scale);
  const Eigen::ArrayXd r = std::sqrt(5.0) * s.sqrt();
  Eigen::ArrayXd decay = -r;
  exponentiate(decay);
  column.value = (1.0 + r + 5.0 / 3.0 * s) * decay;
  if (!column.wants_gradient) return;
  const Eigen::ArrayXd slope = -5.0 / 6.0 * (1.0 + r) * decay;
  set_length_gradient(points, other, scale, parameters.size(), s, slope, column);
}

}  // namespace

extern const KernelFamily matern_5_2_kernel;
constinit const KernelFamily matern_5_2_kernel{
    .name = "matern_5_2",
    .summary = "(1 + q + q^2 / 3) exp(-q), q = sqrt(5) r: differentiable twice",
    .source = "Rasmussen and Williams 2006, (4.17)",
    .is_stationary = true,
    .is_isotropic = true,
    .parameters = length_scales,
    .evaluate = matern_5_2_column,
};

}  // namespace chladni::priors
