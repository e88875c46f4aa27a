#include "placement/candidates.h"

#include <algorithm>
#include <unordered_map>

#include "base/error.h"

namespace chladni::placement {
namespace {

// Rows of a surface without those that see at the same node what an earlier one sees: where
// patches meet, a node occurs once for each of them, and it is one place for a device.
std::vector<Eigen::Index> different_places(const Surface& surface, std::vector<Eigen::Index> rows) {
  const auto& shapes = surface.sites.shapes;
  std::unordered_multimap<int, Eigen::Index> known;
  std::erase_if(rows, [&](Eigen::Index row) {
    const auto [begin, end] = known.equal_range(surface.node(row));
    const bool is_known = std::any_of(
        begin, end, [&](const auto& other) { return shapes.row(other.second) == shapes.row(row); });
    if (!is_known) known.emplace(surface.node(row), row);
    return is_known;
  });
  return rows;
}

}  // namespace

std::vector<Eigen::Vector2d> places_of(const Grid& grid) {
  std::vector<Eigen::Vector2d> places;
  for (int i = 0; i < grid.columns; ++i) {
    for (int j = 0; j < grid.rows; ++j) {
      const Eigen::Vector2d offset(i - 0.5 * (grid.columns - 1), j - 0.5 * (grid.rows - 1));
      places.emplace_back(grid.centre + offset.cwiseProduct(grid.pitch));
    }
  }
  return places;
}

Candidates candidates_on(const Surface& surface, const std::vector<Rule>& rules) {
  const auto rows = admissible(forbidden_by(surface.sites, rules), rules);
  return {part(surface.sites, different_places(surface, rows)), false, surface.faces};
}

Candidates candidates_on(const Grid& grid, const Sampler& sampler, const Surface& surface,
                         const std::vector<Rule>& rules) {
  const FaceFinder finder(sampler.body(), surface.faces);
  std::vector<mesh::Site> places;
  bool is_on_body = false;
  for (const auto& at : places_of(grid)) {
    if (const auto site = finder.on_line(at.x(), at.y())) places.push_back(*site);
    is_on_body = is_on_body || sampler.finder().from_above(at.x(), at.y()).has_value();
  }
  require(is_on_body || !places.empty(), "placement.grid: none of its places lies on the body");
  require(!places.empty(),
          "placement.grid: none of its places, seen from above, lies on the faces that devices may "
          "be on (placement.on)");
  const auto sites = sampler.at(places);
  return {part(sites, admissible(forbidden_by(sites, rules), rules)), true, surface.faces};
}

}  // namespace chladni::placement
