#include "mesh/tets/triangle.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "mesh/tet_mesh.h"

namespace chladni::mesh {
namespace {

// Barycentric coordinates of the nodes, times the order. They are whole numbers.
const Eigen::MatrixXi& lattice(int order) {
  static const std::array<Eigen::MatrixXi, 3> lattices = [] {
    std::array<Eigen::MatrixXi, 3> by_order;
    for (int p = 1; p <= 3; ++p) {
      by_order[static_cast<std::size_t>(p - 1)] =
          (p * triangle_node_barycentric(p)).array().round().cast<int>().matrix();
    }
    return by_order;
  }();
  return lattices[static_cast<std::size_t>(order - 1)];
}

// Π_{m < n} (p l − m) / (m + 1) and its derivative by l (Silvester 1969).
struct Factor {
  double value = 1.0, slope = 0.0;
};
Factor factor(int order, int n, double l) {
  Factor f;
  for (int m = 0; m < n; ++m) {
    const double here = (order * l - m) / (m + 1.0);
    f.slope = f.slope * here + f.value * order / (m + 1.0);
    f.value *= here;
  }
  return f;
}

// The position along the segment a–b (0 to 1) of its point nearest to p.
double along_segment(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& p) {
  const double length = (b - a).squaredNorm();
  return length > 0.0 ? std::clamp((p - a).dot(b - a) / length, 0.0, 1.0) : 0.0;
}

Eigen::Vector3d nearest_on_outline(const Eigen::Matrix3d& corners, const Eigen::Vector3d& point) {
  Eigen::Vector3d best = Eigen::Vector3d::UnitX();
  double least = HUGE_VAL;
  for (const auto& [a, b] : kTriangleEdges) {
    const Eigen::Vector3d from = corners.row(a);
    const Eigen::Vector3d to = corners.row(b);
    const double t = along_segment(from, to, point);
    const double distance = (from + t * (to - from) - point).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    best.setZero();
    best(a) = 1.0 - t;
    best(b) += t;
  }
  return best;
}

}  // namespace

FaceShape face_shape(int order, const Eigen::Vector3d& barycentric) {
  const Eigen::MatrixXi& nodes = lattice(order);
  FaceShape shape;
  shape.value.resize(nodes.rows());
  shape.by_barycentric.resize(nodes.rows(), 3);
  for (Eigen::Index a = 0; a < nodes.rows(); ++a) {
    const Factor f = factor(order, nodes(a, 0), barycentric(0));
    const Factor g = factor(order, nodes(a, 1), barycentric(1));
    const Factor h = factor(order, nodes(a, 2), barycentric(2));
    shape.value(a) = f.value * g.value * h.value;
    shape.by_barycentric.row(a) << f.slope * g.value * h.value, f.value * g.slope * h.value,
        f.value * g.value * h.slope;
  }
  return shape;
}

Eigen::Vector3d nearest_in_triangle(const Eigen::Matrix3d& corners, const Eigen::Vector3d& point) {
  const Eigen::Vector3d a = corners.row(0);
  const Eigen::Vector3d b = corners.row(1);
  const Eigen::Vector3d c = corners.row(2);
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double twice = normal.squaredNorm();
  const double longest =
      std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  if (twice > 1e-24 * longest * longest) {
    const Eigen::Vector3d inside(normal.dot((c - b).cross(point - b)) / twice,
                                 normal.dot((a - c).cross(point - c)) / twice,
                                 normal.dot((b - a).cross(point - a)) / twice);
    if (inside.minCoeff() >= 0.0) return inside / inside.sum();
  }
  return nearest_on_outline(corners, point);
}

Eigen::Vector3d nearest_on_face(const FaceNodes& nodes, int order, const Eigen::Vector3d& point) {
  Eigen::Vector3d at = nearest_in_triangle(nodes.topRows<3>(), point);
  FaceShape shape = face_shape(order, at);
  Eigen::Vector3d here = nodes.transpose() * shape.value;
  for (int iteration = 0; iteration < 30; ++iteration) {
    // The triangle in the tangent plane, with the corners at (1,0,0), (0,1,0), (0,0,1).
    const Eigen::Matrix3d slope = nodes.transpose() * shape.by_barycentric;  // columns: by l0 l1 l2
    const Eigen::Vector3d foot = here - slope * at;
    const Eigen::Matrix3d tangent = (slope.colwise() + foot).transpose();
    const Eigen::Vector3d step = nearest_in_triangle(tangent, point) - at;
    const double distance = (here - point).squaredNorm();
    bool nearer = false;
    double part = 1.0;
    for (; part > 1e-3 && !nearer; part /= 2.0) {
      const Eigen::Vector3d next = at + part * step;
      const FaceShape there = face_shape(order, next);
      const Eigen::Vector3d position = nodes.transpose() * there.value;
      if ((position - point).squaredNorm() >= distance) continue;
      at = next;
      shape = there;
      here = position;
      nearer = true;
    }
    if (!nearer || step.cwiseAbs().maxCoeff() < 1e-14) break;
  }
  return at;
}

VerticalCrossing vertical_crossing(const FaceNodes& nodes, int order, bool curved,
                                   const Eigen::Vector2d& at) {
  constexpr double kTolerance = 1e-9;  // relative to the face: lines through its outline hit it
  VerticalCrossing result;
  result.barycentric.setConstant(1.0 / 3.0);
  const int iterations = curved ? 30 : 1;
  for (int i = 0; i < iterations; ++i) {
    const int p = curved ? order : 1;
    const FaceShape shape = face_shape(p, result.barycentric);
    const auto used = nodes.topRows(shape.value.size());
    const Eigen::Matrix3d slope = used.transpose() * shape.by_barycentric;
    const Eigen::Vector2d miss = at - (used.transpose() * shape.value).head<2>();
    Eigen::Matrix2d by_free;  // l1 and l2 free, l0 = 1 − l1 − l2
    by_free.col(0) = (slope.col(1) - slope.col(0)).head<2>();
    by_free.col(1) = (slope.col(2) - slope.col(0)).head<2>();
    const double size = by_free.squaredNorm();
    if (std::abs(by_free.determinant()) <= 1e-12 * size) return result;  // seen edge on
    Eigen::Vector2d step = by_free.inverse() * miss;
    if (curved) step *= std::min(1.0, 0.5 / step.cwiseAbs().maxCoeff());
    result.barycentric += Eigen::Vector3d(-step.sum(), step(0), step(1));
    if (step.cwiseAbs().maxCoeff() < 1e-15) break;
  }
  if (result.barycentric.minCoeff() < -kTolerance || !result.barycentric.allFinite()) return result;
  if (curved) {
    const FaceValues value = face_shape(order, result.barycentric).value;
    const double off = ((nodes.transpose() * value).head<2>() - at).norm();
    const double extent =
        (nodes.row(1) - nodes.row(0)).norm() + (nodes.row(2) - nodes.row(0)).norm();
    if (off > kTolerance * extent) return result;
  }
  result.barycentric = result.barycentric.cwiseMax(0.0);
  result.barycentric /= result.barycentric.sum();
  result.found = true;
  return result;
}

double sag(const FaceNodes& nodes, int order) {
  double most = 0.0;
  const Eigen::MatrixXi& at = lattice(order);
  for (Eigen::Index a = 3; a < nodes.rows(); ++a) {
    const Eigen::RowVector3d flat =
        at.row(a).cast<double>() / static_cast<double>(order) * nodes.topRows<3>();
    most = std::max(most, (nodes.row(a) - flat).norm());
  }
  return most;
}

}  // namespace chladni::mesh
