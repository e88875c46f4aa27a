#include "stage/estimates/waves.h"

#include <cmath>
#include <numbers>

#include "mesh/surface.h"

namespace chladni::stage {

std::pair<Eigen::Index, Eigen::Index> longest_sides(const mesh::TetMesh& body) {
  const auto box = mesh::bounding_box(body.points);
  Eigen::RowVector3d size = box.row(1) - box.row(0);
  Eigen::Index first = 0;
  Eigen::Index second = 0;
  size.maxCoeff(&first);
  size(first) = -1.0;
  size.maxCoeff(&second);
  return {first, second};
}

Eigen::MatrixXd waves(const mesh::TetMesh& body, int count) {
  const auto box = mesh::bounding_box(body.points);
  const Eigen::RowVector3d size = box.row(1) - box.row(0);
  const auto [u, v] = longest_sides(body);
  Eigen::MatrixXd fields(body.tet_count(), count * count);
  for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
    Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
    for (int a = 0; a < 4; ++a) centre += 0.25 * body.points.row(body.tets(t, a));
    const double along_u = std::numbers::pi * (centre(u) - box(0, u)) / size(u);
    const double along_v = std::numbers::pi * (centre(v) - box(0, v)) / size(v);
    for (int k = 0; k < count * count; ++k) {
      fields(t, k) = std::cos(k / count * along_u) * std::cos(k % count * along_v);
    }
  }
  return fields;
}

}  // namespace chladni::stage
