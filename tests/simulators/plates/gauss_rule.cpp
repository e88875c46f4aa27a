#include "simulators/plates/gauss_rule.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace chladni::simulators {
namespace {

using Eigen::Index;
using std::numbers::pi;

// The distance from the centre to the rim of the rectangle in one direction.
double reach(const Eigen::Vector2d& centre, const Eigen::Vector2d& half, double angle) {
  const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
  double far = std::numeric_limits<double>::infinity();
  for (Index axis = 0; axis < 2; ++axis) {
    if (std::abs(direction(axis)) < 1e-14) continue;
    const double wall = direction(axis) > 0.0 ? half(axis) : -half(axis);
    far = std::min(far, std::max(0.0, (wall - centre(axis)) / direction(axis)));
  }
  return far;
}

// Angles at which the rim of the disc's part on the rectangle has a kink, ascending over one turn.
std::vector<double> kinks(const Eigen::Vector2d& centre, double radius,
                          const Eigen::Vector2d& half) {
  std::vector<double> angles = {-pi, -0.5 * pi, 0.0, 0.5 * pi, pi};
  const auto note = [&angles](double angle) { angles.push_back(std::remainder(angle, 2.0 * pi)); };
  for (int side = 0; side < 4; ++side) {
    const Index axis = side % 2;
    const double away = half(axis) + (side < 2 ? -centre(axis) : centre(axis));
    if (away >= radius) continue;
    const double towards = 0.5 * pi * (static_cast<double>(axis) + (side < 2 ? 0.0 : 2.0));
    note(towards + std::acos(away / radius));
    note(towards - std::acos(away / radius));
  }
  for (const double x : {-half.x(), half.x()}) {
    for (const double y : {-half.y(), half.y()}) {
      const Eigen::Vector2d corner = Eigen::Vector2d(x, y) - centre;
      if (corner.norm() < radius) note(std::atan2(corner.y(), corner.x()));
    }
  }
  std::sort(angles.begin(), angles.end());
  return angles;
}

}  // namespace

LineRule gauss_rule(int points) {
  Eigen::MatrixXd jacobi = Eigen::MatrixXd::Zero(points, points);
  for (int k = 1; k < points; ++k) {
    jacobi(k, k - 1) = jacobi(k - 1, k) = k / std::sqrt(4.0 * k * k - 1.0);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(jacobi);
  return {solver.eigenvalues(), 2.0 * solver.eigenvectors().row(0).cwiseAbs2().transpose()};
}

AreaRule rectangle_rule(const Eigen::Vector2d& low, const Eigen::Vector2d& high, int points) {
  const auto line = gauss_rule(points);
  const Eigen::Vector2d middle = 0.5 * (low + high);
  const Eigen::Vector2d half = 0.5 * (high - low);
  AreaRule rule{Eigen::MatrixX2d(points * points, 2), Eigen::VectorXd(points * points)};
  for (Index i = 0, k = 0; i < points; ++i) {
    for (Index j = 0; j < points; ++j, ++k) {
      rule.places.row(k) << middle.x() + half.x() * line.point(i),
          middle.y() + half.y() * line.point(j);
      rule.area(k) = half.x() * half.y() * line.weight(i) * line.weight(j);
    }
  }
  return rule;
}

AreaRule disc_rule(const Eigen::Vector2d& centre, double radius, const Eigen::Vector2d& half,
                   int points) {
  const auto line = gauss_rule(points);
  const auto angles = kinks(centre, radius, half);
  std::vector<Eigen::Vector3d> found;
  for (std::size_t s = 0; s + 1 < angles.size(); ++s) {
    const double sector = 0.5 * (angles[s + 1] - angles[s]);
    if (sector < 1e-12) continue;
    for (Index i = 0; i < points; ++i) {
      const double angle = angles[s] + sector * (1.0 + line.point(i));
      const double rim = std::min(radius, reach(centre, half, angle));
      if (rim <= 0.0) continue;
      for (Index j = 0; j < points; ++j) {
        const double r = 0.5 * rim * (1.0 + line.point(j));
        found.emplace_back(centre.x() + r * std::cos(angle), centre.y() + r * std::sin(angle),
                           sector * line.weight(i) * 0.5 * rim * line.weight(j) * r);
      }
    }
  }
  const auto k = static_cast<Index>(found.size());
  AreaRule rule{Eigen::MatrixX2d(k, 2), Eigen::VectorXd(k)};
  for (Index i = 0; i < k; ++i) {
    rule.places.row(i) = found[static_cast<std::size_t>(i)].head<2>().transpose();
    rule.area(i) = found[static_cast<std::size_t>(i)].z();
  }
  return rule;
}

AreaRule band_rule(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double width, int along,
                   int across) {
  const auto far = gauss_rule(along);
  const auto near = gauss_rule(across);
  const Eigen::Vector2d half = 0.5 * (to - from);
  const Eigen::Vector2d normal = Eigen::Vector2d(-half.y(), half.x()).normalized();
  AreaRule rule{Eigen::MatrixX2d(along * across, 2), Eigen::VectorXd(along * across)};
  for (Index i = 0, k = 0; i < along; ++i) {
    for (Index j = 0; j < across; ++j, ++k) {
      rule.places.row(k) =
          (from + (1.0 + far.point(i)) * half + 0.5 * width * near.point(j) * normal).transpose();
      rule.area(k) = half.norm() * far.weight(i) * 0.5 * width * near.weight(j);
    }
  }
  return rule;
}

}  // namespace chladni::simulators
