#include "placement/refine.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "placement/constants.h"

namespace chladni::placement {
namespace {

std::vector<mesh::Site> neighbours(const Sampler& sampler, const FaceFinder* faces, const Sites& at,
                                   double step) {
  const auto nearest = [&](const Eigen::Vector3d& place) {
    return faces != nullptr ? faces->nearest(place) : sampler.finder().nearest(place);
  };
  const Eigen::Vector3d normal = at.normal.row(0).transpose();
  Eigen::Index axis = 0;
  normal.cwiseAbs().minCoeff(&axis);
  const Eigen::Vector3d u = normal.cross(Eigen::Vector3d::Unit(axis)).normalized();
  const Eigen::Vector3d v = normal.cross(u);
  std::vector<mesh::Site> found;
  for (int k = 0; k < 8; ++k) {
    const double angle = 0.25 * std::numbers::pi * k;
    const Eigen::Vector3d place =
        at.position.row(0).transpose() + step * (std::cos(angle) * u + std::sin(angle) * v);
    auto site = nearest(place);
    // An edge belongs to two faces: do not go around the corner onto the other face.
    if (site.normal.dot(normal) < Constants::same_face) {
      const Eigen::Vector3d here = at.position.row(0).transpose();
      site = nearest(site.position + 1e-3 * (here - site.position));
    }
    if (site.normal.dot(normal) >= Constants::same_face) found.push_back(site);
  }
  return found;
}

}  // namespace

Sites refined(const Sampler& sampler, const Sites& start, const Worth& worth, double step,
              double tolerance, const FaceFinder* faces) {
  Sites best = start;
  double height = worth(start)(0);
  for (int steps = 0; step >= tolerance && steps < Constants::refine_steps; ++steps) {
    const auto around = neighbours(sampler, faces, best, step);
    Eigen::Index top = 0;
    const Sites sites = sampler.at(around);
    const double reached = around.empty() ? -HUGE_VAL : worth(sites).maxCoeff(&top);
    if (reached > height) {
      best = part(sites, {top});
      height = reached;
    } else {
      step *= 0.5;
    }
  }
  return best;
}

}  // namespace chladni::placement
