// Pictures of a surface coloured by the quality of its places.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "io/picture_file.h"
#include "io/vtu.h"

namespace chladni::io {

/// n points of a surface with the triangles between them.
struct HeatMapPicture {
  std::string title;
  std::string scale;            ///< meaning of the colours
  std::string lowest, highest;  ///< values at the ends of the colour bar
  Points points;                ///< n×3 [m]
  Cells triangles;              ///< t×3
  Eigen::VectorXd value;        ///< n, in [0, 1]
  std::vector<char> forbidden;  ///< n: 1 where nothing may be placed (drawn grey)
  std::vector<std::pair<std::string, Eigen::VectorXd>> nodal_lines;  ///< name, n values
  struct Best {
    Eigen::Vector3d position;
    std::string label;
  };
  std::vector<Best> best;                                     ///< the best first
  std::string star = "best places of a pair, limiting mode";  ///< meaning of a star of `best`
  std::vector<Marker> markers;                                ///< channels
};

/// Draws the surface seen along its mean normal. PNG, 1000 px wide; the same input gives the same
/// bytes.
/// @throws WorkerDied  as draw_modes
void draw_heat_map(const PictureFile& png, const HeatMapPicture& picture);

/// Several layouts on the same surface.
struct LayoutsPicture {
  std::string title, scale, lightest, darkest;
  Points points;    ///< n×3 [m]
  Cells triangles;  ///< t×3
  struct Panel {
    std::string title, note;
    Eigen::VectorXd value;  ///< n, in [0, 1], light is good
    std::vector<Marker> markers;
  };
  std::vector<Panel> panels;
};

/// Draws panels beside each other, each with its channels. PNG, 1000 px wide.
/// @throws WorkerDied  as draw_modes
void draw_layouts(const PictureFile& png, const LayoutsPicture& picture);

}  // namespace chladni::io
