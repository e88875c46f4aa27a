// The frame of a surface, seen along its normal, on the canvas.
#pragma once

#include "base/arrays.h"
#include "io/figure/view.h"
#include "io/picture/canvas.h"

namespace chladni::picture {

struct MapFrame {
  io::View view;
  Eigen::Vector2d corner, size;  ///< of the panel [px]

  [[nodiscard]] Eigen::Vector2d on_canvas(const Eigen::Vector3d& point) const {
    return corner + 0.5 * size + view.at(point);
  }
};

/// The frame that shows `points` (V×3, x right, y up, z towards the eye) as large as possible in a
/// panel at `corner`, `width` wide and at most `highest` high [px].
[[nodiscard]] MapFrame map_frame(const Points& points, const Eigen::Vector2d& corner, double width,
                                 double highest);

/// Paints a rectangle with its upper left corner at (left, top) [px].
void paint_rectangle(Canvas& canvas, double left, double top, double width, double height,
                     const Colour& colour, double line);

}  // namespace chladni::picture
