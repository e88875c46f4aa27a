#include "priors/gaussian_process/exponential.h"
#include "priors/kernels/radial.h"

namespace chladni::priors {
namespace {

void squared_exponential_column(const CoordinatesView& points, const Eigen::RowVector3d& other,
                                const Eigen::VectorXd& parameters, KernelColumn& column) {
  const auto scale = lengths(parameters, 0);
  const Eigen::ArrayXd s = scaled_square(points, other, scale);
  column.value = -0.5 * s;
  exponentiate(column.value);
  if (!column.wants_gradient) return;
  const Eigen::ArrayXd slope = -0.5 * column.value;
  set_length_gradient(points, other, scale, parameters.size(), s, slope, column);
}

}  // namespace

extern const KernelFamily squared_exponential_kernel;
constinit const KernelFamily squared_exponential_kernel{
    .name = "squared_exponential",
    .summary = "exp(-r^2 / 2), r the distance over the length scale: smooth without limit",
    .source = "thesis (5.17)",
    .is_stationary = true,
    .is_isotropic = true,
    .parameters = length_scales,
    .evaluate = squared_exponential_column,
};

}  // namespace chladni::priors
