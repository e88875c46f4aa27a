#include "stage/points_on_body.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "base/error.h"
#include "mesh/surface.h"

namespace chladni::stage {
namespace {

std::string in_mm(const Eigen::Vector3d& at) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g}) mm", 1e3 * at.x(), 1e3 * at.y(), 1e3 * at.z());
}

}  // namespace

double reach_of(const mesh::TetMesh& body) {
  constexpr double kFarthest = 1e-3;  // [m]
  constexpr double kShare = 0.01;
  const auto box = mesh::bounding_box(body.points);
  return std::min(kFarthest, kShare * (box.row(1) - box.row(0)).maxCoeff());
}

std::vector<mesh::Site> sites_near(const mesh::SiteFinder& finder, const Points& points,
                                   double reach) {
  std::vector<mesh::Site> sites;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Eigen::Vector3d point = points.row(i);
    require(point.allFinite(), fmt::format("point {} is not finite", i));
    sites.push_back(finder.nearest(point));
    const auto& nearest = sites.back().position;
    const double off = (nearest - point).norm();
    require(off <= reach,
            fmt::format("point {} at {} is {:.4g} mm off the surface of the body; nearest is {}", i,
                        in_mm(point), 1e3 * off, in_mm(nearest)));
  }
  return sites;
}

mesh::Site site_at(const mesh::SiteFinder& finder, const study::Place& place) {
  if (!place.from_above) return finder.nearest(place.point);
  auto site = finder.from_above(place.point.x(), place.point.y());
  return site ? *std::move(site) : finder.beside(place.point.x(), place.point.y());
}

Points directions_at(const std::vector<mesh::Site>& sites,
                     const std::optional<Points>& directions) {
  const auto n = static_cast<Eigen::Index>(sites.size());
  Points result(n, 3);
  if (!directions) {
    for (Eigen::Index i = 0; i < n; ++i) {
      result.row(i) = sites[static_cast<std::size_t>(i)].normal.transpose();
    }
    return result;
  }
  require(
      directions->rows() == 1 || directions->rows() == n,
      fmt::format("there are {} directions for {} points; expected one for all, or one for each",
                  directions->rows(), n));
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::RowVector3d given = directions->row(directions->rows() == 1 ? 0 : i);
    require(given.allFinite() && given.norm() > 0.0,
            fmt::format("direction {} is ({:.6g}, {:.6g}, {:.6g}); expected a vector of any length "
                        "but 0",
                        i, given.x(), given.y(), given.z()));
    result.row(i) = given.normalized();
  }
  return result;
}

}  // namespace chladni::stage
