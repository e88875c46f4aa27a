// The picture of a heat map.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "io/vtu.h"

namespace chladni::io {

/// n points of a surface with the triangles between them.
struct HeatMapPicture {
  std::string title;
  std::string scale;            ///< what the colours mean
  std::string lowest, highest;  ///< values at the ends of the colour bar
  Points points;                ///< n×3 [m]
  Cells triangles;              ///< t×3
  Eigen::VectorXd value;        ///< n, in [0, 1]
  std::vector<char> forbidden;  ///< n: 1 where nothing may be placed, drawn grey
  std::vector<std::pair<std::string, Eigen::VectorXd>> nodal_lines;  ///< name, n values
  struct Best {
    Eigen::Vector3d position;
    std::string label;
  };
  std::vector<Best> best;       ///< the best first
  std::vector<Marker> markers;  ///< channels
};

/// Seen along the surface's mean normal. PNG, 1000 px wide; the same input gives the same bytes.
/// @throws WorkerDied  as draw_modes
void draw_heat_map(const std::filesystem::path& png, const HeatMapPicture& picture);

}  // namespace chladni::io
