// Quality of tetrahedra (by their corners), and the volume of a mesh.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "mesh/tet_mesh.h"
#include "mesh/tets/triangle.h"

namespace chladni::mesh {
namespace {

using Corners = std::array<Eigen::Vector3d, 4>;

Corners corners_of(const TetMesh& mesh, Eigen::Index tet) {
  Corners corner;
  for (std::size_t a = 0; a < 4; ++a) {
    corner[a] = mesh.points.row(mesh.tets(tet, static_cast<Eigen::Index>(a)));
  }
  return corner;
}

double signed_volume(const Corners& p) {
  return (p[1] - p[0]).dot((p[2] - p[0]).cross(p[3] - p[0])) / 6.0;
}

// 3 r_in / r_circumscribed. Let p, q, r be the products of opposite edges. Then r_in = 3V / A and
// 24 V R = sqrt((p+q+r)(p+q-r)(p-q+r)(-p+q+r)) (Crelle 1821).
double radius_ratio(const Corners& c, double volume, double area) {
  const double p = (c[1] - c[0]).norm() * (c[3] - c[2]).norm();
  const double q = (c[2] - c[0]).norm() * (c[3] - c[1]).norm();
  const double r = (c[3] - c[0]).norm() * (c[2] - c[1]).norm();
  const double product = (p + q + r) * (p + q - r) * (p - q + r) * (-p + q + r);
  if (product <= 0.0 || area <= 0.0) return 0.0;
  return 216.0 * volume * volume / (area * std::sqrt(product));
}

// Extends the limits in `quality` by one tetrahedron; returns its radius ratio.
double include(Quality& quality, const Corners& corner) {
  std::array<Eigen::Vector3d, 4> area_vector;  // outward, of twice the area
  double area = 0.0;
  for (std::size_t f = 0; f < 4; ++f) {
    const auto& [a, b, c] = kTetFaces[f];
    const Eigen::Vector3d& at = corner[static_cast<std::size_t>(a)];
    area_vector[f] =
        (corner[static_cast<std::size_t>(b)] - at).cross(corner[static_cast<std::size_t>(c)] - at);
    area += area_vector[f].norm() / 2.0;
  }
  for (std::size_t f = 0; f < 4; ++f) {
    for (std::size_t g = 0; g < f; ++g) {
      const double angle =
          std::numbers::pi - std::atan2(area_vector[f].cross(area_vector[g]).norm(),
                                        area_vector[f].dot(area_vector[g]));
      const double degrees = angle * 180.0 / std::numbers::pi;
      quality.smallest_dihedral_degrees = std::min(quality.smallest_dihedral_degrees, degrees);
      quality.largest_dihedral_degrees = std::max(quality.largest_dihedral_degrees, degrees);
    }
  }
  for (const auto& [a, b] : kTetEdges) {
    const double length =
        (corner[static_cast<std::size_t>(a)] - corner[static_cast<std::size_t>(b)]).norm();
    quality.shortest_edge = std::min(quality.shortest_edge, length);
    quality.longest_edge = std::max(quality.longest_edge, length);
  }
  const double volume = signed_volume(corner);
  quality.smallest_volume = std::min(quality.smallest_volume, volume);
  return volume > 0.0 ? radius_ratio(corner, volume, area) : 0.0;
}

// The volume between a curved face and the flat triangle of its corners: the difference of the two
// integrals ∫ x·n / 3 about `origin`. The Gauss rule on the collapsed square is exact up to
// order 3.
double bulge(const TetMesh& mesh, Eigen::Index face, const Eigen::Vector3d& origin) {
  constexpr std::array<double, 5> kAt{0.046910077030668, 0.230765344947158, 0.5, 0.769234655052841,
                                      0.953089922969332};
  constexpr std::array<double, 5> kWeight{0.118463442528095, 0.239314335249683, 0.284444444444444,
                                          0.239314335249683, 0.118463442528095};
  const FaceNodes nodes =
      mesh.points(mesh.faces.row(face), Eigen::all).rowwise() - origin.transpose();
  if (sag(nodes, mesh.order()) <= 1e-12 * (nodes.row(1) - nodes.row(0)).norm()) return 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < kAt.size(); ++i) {
    for (std::size_t j = 0; j < kAt.size(); ++j) {
      const double u = kAt[i];
      const double v = kAt[j] * (1.0 - u);
      const auto shape = face_shape(mesh.order(), {1.0 - u - v, u, v});
      const Eigen::Vector3d at = nodes.transpose() * shape.value;
      const Eigen::Matrix3d by = nodes.transpose() * shape.by_barycentric;
      const Eigen::Vector3d normal = (by.col(1) - by.col(0)).cross(by.col(2) - by.col(0));
      sum += kWeight[i] * kWeight[j] * (1.0 - u) * at.dot(normal) / 3.0;
    }
  }
  const Eigen::Vector3d a = nodes.row(0);
  const Eigen::Vector3d b = nodes.row(1);
  const Eigen::Vector3d c = nodes.row(2);
  return sum - a.dot(b.cross(c)) / 6.0;
}

}  // namespace

double volume(const TetMesh& mesh) {
  double sum = 0.0;
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) sum += signed_volume(corners_of(mesh, t));
  if (mesh.order() == 1) return sum;
  const Eigen::Vector3d origin = mesh.points.colwise().mean();
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) sum += bulge(mesh, f, origin);
  return sum;
}

Quality quality(const TetMesh& mesh) {
  if (mesh.tets.rows() == 0) return {};
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Quality result{.smallest_dihedral_degrees = 180.0,
                 .smallest_radius_ratio = kInfinity,
                 .smallest_volume = kInfinity,
                 .shortest_edge = kInfinity};
  double sum = 0.0;
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    const double ratio = include(result, corners_of(mesh, t));
    sum += ratio;
    if (ratio < result.smallest_radius_ratio) {
      result.smallest_radius_ratio = ratio;
      result.worst_tet = t;
    }
  }
  result.mean_radius_ratio = sum / static_cast<double>(mesh.tets.rows());
  return result;
}

}  // namespace chladni::mesh
