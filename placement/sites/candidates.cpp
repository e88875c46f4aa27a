#include "placement/candidates.h"

#include "base/error.h"

namespace chladni::placement {

Candidates candidates_on(const Surface& surface, const std::vector<Rule>& rules) {
  return {part(surface.sites, admissible(forbidden_by(surface.sites, rules), rules)), false};
}

Candidates candidates_on(const Grid& grid, const Sampler& sampler, const std::vector<Rule>& rules) {
  std::vector<mesh::Site> places;
  for (int i = 0; i < grid.columns; ++i) {
    for (int j = 0; j < grid.rows; ++j) {
      const Eigen::Vector2d offset(i - 0.5 * (grid.columns - 1), j - 0.5 * (grid.rows - 1));
      const Eigen::Vector2d at = grid.centre + offset.cwiseProduct(grid.pitch);
      if (const auto site = sampler.finder().from_above(at.x(), at.y())) places.push_back(*site);
    }
  }
  require(!places.empty(), "placement.grid: none of its places lies on the body");
  const auto sites = sampler.at(places);
  return {part(sites, admissible(forbidden_by(sites, rules), rules)), true};
}

}  // namespace chladni::placement
