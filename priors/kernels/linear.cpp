#include "priors/kernels/radial.h"

namespace chladni::priors {
namespace {

void linear_column(const CoordinatesView& points, const Eigen::RowVector3d& other,
                   const Eigen::VectorXd& parameters, KernelColumn& column) {
  const auto scale = lengths(parameters, 0);
  const Eigen::RowVector3d there = other.cwiseQuotient(scale.cwiseAbs2());
  column.value = 1.0 + (points * there.transpose()).array();
  if (!column.wants_gradient) return;
  if (parameters.size() == 1) {
    column.gradient = -2.0 * (column.value - 1.0);
  } else {
    column.gradient = -2.0 * (points * there.asDiagonal()).array();
  }
}

}  // namespace

extern const KernelFamily linear_kernel;
constinit const KernelFamily linear_kernel{
    .name = "linear",
    .summary = "1 + x . x' / length^2: planes, the steeper the shorter the length",
    .source = "Rasmussen and Williams 2006, 4.2.2",
    .is_stationary = false,
    .is_isotropic = false,
    .parameters = length_scales,
    .evaluate = linear_column,
};

}  // namespace chladni::priors
