// Zones where no device may be placed, with the rule that forbids them.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "placement/sites.h"

namespace chladni::placement {

/// A box between two corners, seen from above.
struct KeepOutBox {
  Eigen::Vector2d from, to;  ///< [m], any two opposite corners
};
/// A disc around a vertical line.
struct KeepOutDisc {
  Eigen::Vector2d centre;  ///< [m]
  double diameter = 0.0;   ///< [m]
};
/// A patch of the surface.
struct KeepOutPatch {
  int patch = -1;
};
/// The zone near an edge where the surface ends or another patch begins.
struct KeepFromEdges {
  double distance = 0.0;  ///< [m]
  Points from, to;        ///< the edges, e×3 [m]
};
/// The zone near existing places.
struct KeepFromPlaces {
  double distance = 0.0;  ///< [m]
  Points places;          ///< p×3 [m]
};
/// Forbids footprints that do not lie completely on the body.
struct WholeFootprints {};

struct Rule {
  std::string name;  ///< name in messages: "the disc of 80 mm at (0, 0) mm"
  std::variant<KeepOutBox, KeepOutDisc, KeepOutPatch, KeepFromEdges, KeepFromPlaces,
               WholeFootprints>
      what;
};

/// For each site the first rule that forbids it, or −1. The border of a zone is forbidden.
[[nodiscard]] Eigen::VectorXi forbidden_by(const Sites& sites, const std::vector<Rule>& rules);

/// The rows of the sites that lie in a zone.
[[nodiscard]] std::vector<Eigen::Index> within(const Sites& sites, const std::vector<Rule>& zones);

/// The rows that no rule forbids.
/// @throws InvalidInput  no row is left; the message counts the sites that each rule took and names
///                       the last rule
[[nodiscard]] std::vector<Eigen::Index> admissible(const Eigen::VectorXi& forbidden,
                                                   const std::vector<Rule>& rules);

/// The edges of the named patches (of all if `patches` is empty) where the surface ends, another
/// patch begins or another body is met. Cost: n log n in the faces.
[[nodiscard]] KeepFromEdges edges_of(const mesh::TetMesh& body,
                                     const std::vector<std::string>& patches, double distance);

/// The edges where the marked boundary faces end. With `between_patches` also the edges between two
/// of their patches. Cost: as above.
[[nodiscard]] KeepFromEdges edges_around(const mesh::TetMesh& body, const std::vector<char>& faces,
                                         bool between_patches, double distance);

}  // namespace chladni::placement
