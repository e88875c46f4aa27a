#include "priors/kernels/radial.h"

namespace chladni::priors {

std::vector<Hyperparameter> length_scales(Scales scales) {
  if (scales == Scales::isotropic) return {{"length_scale", "m"}};
  return {{"length_scale_x", "m"}, {"length_scale_y", "m"}, {"length_scale_z", "m"}};
}

Eigen::RowVector3d lengths(const Eigen::VectorXd& parameters, Eigen::Index others) {
  if (parameters.size() - others == 1) return Eigen::RowVector3d::Constant(parameters(0));
  return parameters.head<3>().transpose();
}

Eigen::ArrayXd scaled_square(const CoordinatesView& points, const Eigen::RowVector3d& other,
                             const Eigen::RowVector3d& lengths) {
  const Eigen::RowVector3d w = lengths.cwiseAbs2().cwiseInverse();
  return w(0) * (points.col(0).array() - other(0)).square() +
         w(1) * (points.col(1).array() - other(1)).square() +
         w(2) * (points.col(2).array() - other(2)).square();
}

void set_length_gradient(const CoordinatesView& points, const Eigen::RowVector3d& other,
                         const Eigen::RowVector3d& lengths, Eigen::Index length_count,
                         const Eigen::ArrayXd& square, const Eigen::ArrayXd& slope,
                         KernelColumn& column, Eigen::Index others) {
  column.gradient.resize(points.rows(), length_count + others);
  if (length_count == 1) {
    column.gradient.col(0) = -2.0 * slope * square;
    return;
  }
  for (Eigen::Index a = 0; a < 3; ++a) {
    column.gradient.col(a) =
        -2.0 * slope * ((points.col(a).array() - other(a)) / lengths(a)).square();
  }
}

}  // namespace chladni::priors
