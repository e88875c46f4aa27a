// Edges of a surface cut into short ones.
#pragma once

#include <map>
#include <vector>

#include "mesh/surface.h"

namespace chladni::mesh {

struct LineToCut {
  int low = 0, high = 0;     ///< the ends of an edge, low < high
  double edge_length = 0.0;  ///< wanted [m]
};

/// Per line (low, high) its points from low to high, both ends included.
using Chains = std::map<std::pair<int, int>, std::vector<int>>;

/// Cuts edges into equal parts of about their wanted length, at most 4/3 of it, as isotropic
/// remeshing wants them, and the triangles at them with the shortest cuts. New points are appended.
/// Cost: n log n.
Chains split_edges(Surface& surface, const std::vector<LineToCut>& lines);

}  // namespace chladni::mesh
