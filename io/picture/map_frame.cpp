#include "io/picture/map_frame.h"

#include <algorithm>

#include "mesh/surface.h"

namespace chladni::picture {

MapFrame map_frame(const Points& points, const Eigen::Vector2d& corner, double width,
                   double highest) {
  const auto box = mesh::bounding_box(points);
  const Eigen::RowVector3d extent = box.row(1) - box.row(0);
  MapFrame frame;
  frame.size.x() = width;
  const double aspect = extent.x() / std::max(extent.y(), 1e-12);
  frame.size.y() = std::clamp(width / aspect, std::min(160.0, highest), highest);
  frame.corner = corner;
  frame.view.axes = Eigen::Matrix3d::Identity();
  frame.view.centre = 0.5 * (box.row(0) + box.row(1)).transpose();
  frame.view.pixels_per_metre =
      0.98 * std::min(frame.size.x() / extent.x(), frame.size.y() / extent.y());
  return frame;
}

void paint_rectangle(Canvas& canvas, double left, double top, double width, double height,
                     const Colour& colour, double line) {
  canvas.polygon(
      {{left, top}, {left + width, top}, {left + width, top + height}, {left, top + height}},
      colour, kGrey, line);
}

}  // namespace chladni::picture
