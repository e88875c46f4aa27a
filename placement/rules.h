// Where nothing may be placed, and which rule says so.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "placement/sites.h"

namespace chladni::placement {

/// Between two corners, seen from above.
struct KeepOutBox {
  Eigen::Vector2d from, to;  ///< [m], any two opposite corners
};
/// Around a vertical line.
struct KeepOutDisc {
  Eigen::Vector2d centre;  ///< [m]
  double diameter = 0.0;   ///< [m]
};
/// A patch of the surface.
struct KeepOutPatch {
  int patch = -1;
};
/// Near an edge where the surface ends or another patch begins.
struct KeepFromEdges {
  double distance = 0.0;  ///< [m]
  Points from, to;        ///< the edges, e×3 [m]
};
/// Near what is there already.
struct KeepFromPlaces {
  double distance = 0.0;  ///< [m]
  Points places;          ///< p×3 [m]
};
/// Footprints that do not lie on the body with their whole face.
struct WholeFootprints {};

struct Rule {
  std::string name;  ///< as a message calls it: "the disc of 80 mm at (0, 0) mm"
  std::variant<KeepOutBox, KeepOutDisc, KeepOutPatch, KeepFromEdges, KeepFromPlaces,
               WholeFootprints>
      what;
};

/// Per site the first rule that forbids it, or −1. A site on the border of a zone is forbidden.
[[nodiscard]] Eigen::VectorXi forbidden_by(const Sites& sites, const std::vector<Rule>& rules);

/// The rows that no rule forbids.
/// @throws InvalidInput  there is none: says how many sites each rule took, and which took the last
[[nodiscard]] std::vector<Eigen::Index> admissible(const Eigen::VectorXi& forbidden,
                                                   const std::vector<Rule>& rules);

/// The edges of the named patches (of all where `patches` is empty) at which the surface ends,
/// another patch begins or another body is met. Cost: n log n in the faces.
[[nodiscard]] KeepFromEdges edges_of(const mesh::TetMesh& body,
                                     const std::vector<std::string>& patches, double distance);

/// The edges at which the marked boundary faces end; with `between_patches` also those between two
/// patches of them. Cost: as above.
[[nodiscard]] KeepFromEdges edges_around(const mesh::TetMesh& body, const std::vector<char>& faces,
                                         bool between_patches, double distance);

}  // namespace chladni::placement
