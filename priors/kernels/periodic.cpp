#include <numbers>

#include "priors/gaussian_process/exponential.h"
#include "priors/kernels/radial.h"

namespace chladni::priors {
namespace {

std::vector<Hyperparameter> periodic_parameters(Scales scales) {
  if (scales == Scales::isotropic) return {{"period", "m"}, {"roughness", "1", 5e-2, 20.0}};
  return {{"period_x", "m"}, {"period_y", "m"}, {"period_z", "m"}, {"roughness", "1", 5e-2, 20.0}};
}

// k = exp(−2 Σ_a sin²(u_a) / q²), u_a = π (x_a − x'_a) / p_a: one factor per axis.
void periodic_column(const CoordinatesView& points, const Eigen::RowVector3d& other,
                     const Eigen::VectorXd& parameters, KernelColumn& column) {
  const Eigen::Index last = parameters.size() - 1;
  const double factor = 2.0 / (parameters(last) * parameters(last));
  const auto period = lengths(parameters, 1);
  const auto angle = [&](Eigen::Index a) -> Eigen::ArrayXd {
    return std::numbers::pi / period(a) * (points.col(a).array() - other(a));
  };
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(points.rows());
  for (Eigen::Index a = 0; a < 3; ++a) sum += angle(a).sin().square();
  column.value = -factor * sum;
  exponentiate(column.value);
  if (!column.wants_gradient) return;
  column.gradient.setZero(points.rows(), last + 1);
  for (Eigen::Index a = 0; a < 3; ++a) {
    const Eigen::ArrayXd u = angle(a);
    column.gradient.col(last == 1 ? 0 : a) += factor * column.value * u * (2.0 * u).sin();
  }
  column.gradient.col(last) = 2.0 * factor * column.value * sum;
}

}  // namespace

extern const KernelFamily periodic_kernel;
constinit const KernelFamily periodic_kernel{
    .name = "periodic",
    .summary = "exp(-2 sum_a sin^2(pi d_a / period) / roughness^2): repeats itself along each axis",
    .source = "MacKay 1998; Rasmussen and Williams 2006, (4.31)",
    .is_stationary = true,
    .is_isotropic = false,
    .parameters = periodic_parameters,
    .evaluate = periodic_column,
};

}  // namespace chladni::priors
