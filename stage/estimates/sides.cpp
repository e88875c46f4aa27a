#include "stage/estimates/sides.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "base/decompositions.h"
#include "mesh/surface.h"

namespace chladni::stage {
namespace {

// Eigenvectors of ∫(x − c)(x − c)ᵀ over the boundary, the thinnest axis first; a triangle counts by
// its three mid-edges, which is exact for its corners' plane.
Eigen::Matrix3d axes_of_area(const mesh::TetMesh& shell) {
  double area = 0.0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (Eigen::Index f = 0; f < shell.faces.rows(); ++f) {
    const double third = mesh::area(shell.points, shell.faces.row(f).leftCols(3)) / 3.0;
    for (const auto& [a, b] : mesh::kTriangleEdges) {
      const Eigen::Vector3d at =
          0.5 * (shell.points.row(shell.faces(f, a)) + shell.points.row(shell.faces(f, b)));
      area += third;
      first += third * at;
      second += third * at * at.transpose();
    }
  }
  const Eigen::Vector3d centre = first / area;
  const Eigen::MatrixXd spread = second / area - centre * centre.transpose();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(spread).eigenvectors();
}

Eigen::Vector3d sides_along(const Points& seen) {
  const auto box = mesh::bounding_box(seen);
  return (box.row(1) - box.row(0)).transpose();
}

// Turns the points about one axis to the least area of the box around them seen along it.
void turn_about(int axis, Points& seen) {
  constexpr int kSteps = 45;
  const int first = (axis + 1) % 3;
  const int second = (axis + 2) % 3;
  const auto turned = [&](double angle) -> Eigen::MatrixX2d {
    Eigen::MatrixX2d both(seen.rows(), 2);
    both.col(0) = std::cos(angle) * seen.col(first) + std::sin(angle) * seen.col(second);
    both.col(1) = std::cos(angle) * seen.col(second) - std::sin(angle) * seen.col(first);
    return both;
  };
  const auto area = [](const Eigen::MatrixX2d& both) {
    return (both.colwise().maxCoeff() - both.colwise().minCoeff()).prod();
  };
  double best = 0.0;
  double least = area(turned(0.0));
  for (int step = 1; step < kSteps; ++step) {
    const double angle = 0.5 * std::numbers::pi * step / kSteps;
    const double here = area(turned(angle));
    if (here >= least) continue;
    best = angle;
    least = here;
  }
  if (best == 0.0) return;
  const Eigen::MatrixX2d both = turned(best);
  seen.col(first) = both.col(0);
  seen.col(second) = both.col(1);
}

// The sides of the smallest box that turns about single axes find from the body's own ones. Axes of
// equal area are turned at will: those of a square bar about its length, of a cube about all.
Eigen::Vector3d own_sides(const mesh::TetMesh& shell) {
  constexpr int kRounds = 3;
  Points seen = shell.points * axes_of_area(shell);
  for (int round = 0; round < kRounds; ++round) {
    const double before = sides_along(seen).prod();
    for (const int axis : {0, 2, 1}) turn_about(axis, seen);  // the thinnest first
    if (sides_along(seen).prod() >= before) break;
  }
  return sides_along(seen);
}

}  // namespace

Eigen::Vector3d sides_of(const mesh::TetMesh& shell) {
  constexpr double kSmaller = 0.98;  // a body along x, y, z keeps its box
  Eigen::Vector3d sides = sides_along(shell.points);
  if (shell.faces.rows() > 0) {
    const Eigen::Vector3d own = own_sides(shell);
    if (own.prod() < kSmaller * sides.prod()) sides = own;
  }
  std::sort(sides.data(), sides.data() + 3, std::greater<>());
  return sides;
}

}  // namespace chladni::stage
