#include "priors/gaussian_process/exponential.h"
#include "priors/kernels/radial.h"

namespace chladni::priors {
namespace {

std::vector<Hyperparameter> rational_quadratic_parameters(Scales scales) {
  auto parameters = length_scales(scales);
  parameters.push_back({"alpha", "1", 1e-2, 1e3});
  return parameters;
}

void rational_quadratic_column(const CoordinatesView& points, const Eigen::RowVector3d& other,
                               const Eigen::VectorXd& parameters, KernelColumn& column) {
  const Eigen::Index last = parameters.size() - 1;
  const double alpha = parameters(last);
  const auto scale = lengths(parameters, 1);
  const Eigen::ArrayXd s = scaled_square(points, other, scale);
  const Eigen::ArrayXd base = 1.0 + s / (2.0 * alpha);
  const Eigen::ArrayXd logarithm = base.log();
  column.value = -alpha * logarithm;
  exponentiate(column.value);
  if (!column.wants_gradient) return;
  const Eigen::ArrayXd slope = -0.5 * column.value / base;
  set_length_gradient(points, other, scale, last, s, slope, column, 1);
  column.gradient.col(last) = alpha * column.value * ((base - 1.0) / base - logarithm);
}

}  // namespace

extern const KernelFamily rational_quadratic_kernel;
constinit const KernelFamily rational_quadratic_kernel{
    .name = "rational_quadratic",
    .summary = "(1 + r^2 / (2 alpha))^-alpha: squared exponentials of many length scales",
    .source = "Rasmussen and Williams 2006, (4.19)",
    .is_stationary = true,
    .is_isotropic = true,
    .parameters = rational_quadratic_parameters,
    .evaluate = rational_quadratic_column,
};

}  // namespace chladni::priors
