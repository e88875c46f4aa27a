#include "stage/plane_stress.h"

#include <Eigen/LU>

namespace chladni::stage {

Eigen::Matrix3d plane_stress(const Eigen::Matrix<double, 6, 6>& stiffness, Eigen::Index u,
                             Eigen::Index v) {
  const Eigen::Index n = 3 - u - v;
  const Eigen::Array3i in(static_cast<int>(u), static_cast<int>(v),
                          static_cast<int>(shear_of(u, v)));
  const Eigen::Array3i out(static_cast<int>(n), static_cast<int>(shear_of(u, n)),
                           static_cast<int>(shear_of(v, n)));
  const Eigen::Matrix3d between = stiffness(in, out);
  const Eigen::Matrix3d free = stiffness(out, out);
  return Eigen::Matrix3d(stiffness(in, in)) - between * free.lu().solve(between.transpose());
}

}  // namespace chladni::stage
