#include <array>
#include <numbers>

#include "priors/kernels/radial.h"

namespace chladni::priors {
namespace {

std::vector<Hyperparameter> cosine_parameters(Scales scales) {
  if (scales == Scales::isotropic) return {{"period", "m"}};
  return {{"period_x", "m"}, {"period_y", "m"}, {"period_z", "m"}};
}

void cosine_column(const CoordinatesView& points, const Eigen::RowVector3d& other,
                   const Eigen::VectorXd& parameters, KernelColumn& column) {
  const auto period = lengths(parameters, 0);
  std::array<Eigen::ArrayXd, 3> angle;
  std::array<Eigen::ArrayXd, 3> wave;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    angle[a] = 2.0 * std::numbers::pi / period(axis) * (points.col(axis).array() - other(axis));
    wave[a] = angle[a].cos();
  }
  column.value = wave[0] * wave[1] * wave[2];
  if (!column.wants_gradient) return;
  column.gradient.setZero(points.rows(), parameters.size());
  for (std::size_t a = 0; a < 3; ++a) {
    const Eigen::Index into = parameters.size() == 1 ? 0 : static_cast<Eigen::Index>(a);
    column.gradient.col(into) += angle[a] * angle[a].sin() * wave[(a + 1) % 3] * wave[(a + 2) % 3];
  }
}

}  // namespace

extern const KernelFamily cosine_kernel;
constinit const KernelFamily cosine_kernel{
    .name = "cosine",
    .summary = "prod_a cos(2 pi d_a / period): sines of one wavelength along each axis",
    .source = "Bochner's theorem with all power at one frequency per axis",
    .is_stationary = true,
    .is_isotropic = false,
    .parameters = cosine_parameters,
    .evaluate = cosine_column,
};

}  // namespace chladni::priors
