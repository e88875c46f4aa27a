#include "mesh/remesh/plane_triangles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "mesh/remesh/flat.h"

namespace chladni::mesh {
namespace {

// Points of a surface, projected on the plane perpendicular to a normal and renumbered.
class Figure {
 public:
  Figure(const Points& points, const Eigen::Vector3d& normal) : points_(points) {
    basis_.col(0) = normal.unitOrthogonal();
    basis_.col(1) = normal.cross(basis_.col(0));
  }

  int number(int i) {
    const auto [known, is_new] = number_.try_emplace(i, static_cast<int>(origin_.size()));
    if (is_new) {
      origin_.push_back(i);
      places_.emplace_back(basis_.transpose() * points_.row(i).transpose());
    }
    return known->second;
  }
  [[nodiscard]] int origin(int number) const { return origin_[static_cast<std::size_t>(number)]; }
  [[nodiscard]] const std::vector<Eigen::Vector2d>& places() const { return places_; }

 private:
  const Points& points_;
  Eigen::Matrix<double, 3, 2> basis_;
  std::map<int, int> number_;
  std::vector<int> origin_;
  std::vector<Eigen::Vector2d> places_;
};

}  // namespace

Points part_normals(const Surface& surface, const std::vector<int>& part) {
  Points normals = Points::Zero(*std::max_element(part.begin(), part.end()) + 1, 3);
  for (std::size_t t = 0; t < part.size(); ++t) {
    const auto corners = surface.triangles.row(static_cast<Eigen::Index>(t));
    const Eigen::RowVector3d a = surface.points.row(corners[0]);
    const Eigen::RowVector3d b = surface.points.row(corners[1]);
    const Eigen::RowVector3d c = surface.points.row(corners[2]);
    normals.row(part[t]) += (b - a).cross(c - a);
  }
  return normals;
}

std::optional<std::vector<Eigen::Vector3i>> plane_triangles(
    const Points& points, const std::vector<Eigen::Vector3i>& through,
    const std::vector<PlaneLine>& rim, const Eigen::RowVector3d& normal) {
  Figure figure(points, normal.normalized());
  std::vector<Line2> lines;
  for (const PlaneLine& line : rim) {
    lines.push_back({figure.number(line.from), figure.number(line.to), line.uses});
  }
  for (const Eigen::Vector3i& corners : through) {
    for (const int i : corners) figure.number(i);
  }
  auto triangles = flat_triangles(figure.places(), lines);
  if (!triangles) return triangles;
  for (Eigen::Vector3i& corners : *triangles) {
    for (int& i : corners) i = figure.origin(i);
  }
  return triangles;
}

}  // namespace chladni::mesh
