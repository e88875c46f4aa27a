// Cuts edges of a surface into shorter ones.
#pragma once

#include <map>
#include <vector>

#include "mesh/surface.h"

namespace chladni::mesh {

struct LineToCut {
  int low = 0, high = 0;     ///< the ends of an edge, low < high
  double edge_length = 0.0;  ///< wanted [m]
};

/// For each line (low, high) its points from low to high, including both ends.
using Chains = std::map<std::pair<int, int>, std::vector<int>>;

/// Cuts edges into equal parts of about the wanted length, at most 4/3 of it, as isotropic
/// remeshing needs. Triangles at these edges are cut with the shortest cuts. New points are
/// appended.
/// Cost: n log n.
Chains split_edges(Surface& surface, const std::vector<LineToCut>& lines);

}  // namespace chladni::mesh
