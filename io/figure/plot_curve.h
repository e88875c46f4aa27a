// Curves between the axes of a plot, in pixels.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "io/figure/drawing.h"
#include "io/figure/plot_axis.h"

namespace chladni::io {

/// The rectangle between the axes of one panel [px].
struct PlotFrame {
  Eigen::Vector2d corner, size;
  PlotAxis x, y;

  [[nodiscard]] Eigen::Vector2d at(double px, double py) const {
    return {corner.x() + size.x() * along(x, px), corner.y() + size.y() * (1.0 - along(y, py))};
  }
  [[nodiscard]] bool holds(const Eigen::Vector2d& p) const {
    return p.allFinite() && p.x() >= corner.x() - 0.5 && p.x() <= corner.x() + size.x() + 0.5 &&
           p.y() >= corner.y() - 0.5 && p.y() <= corner.y() + size.y() + 0.5;
  }
};

/// The connected parts of a curve inside the frame. Points nearer than a fifth of a pixel are
/// merged.
[[nodiscard]] std::vector<Drawing::Path> plot_curve(const PlotFrame& frame,
                                                    const Eigen::VectorXd& x,
                                                    const Eigen::VectorXd& y);

/// The same paths as strokes with gaps between them [px].
[[nodiscard]] std::vector<Drawing::Path> dashed(const std::vector<Drawing::Path>& paths,
                                                double stroke = 7.0, double gap = 5.0);

}  // namespace chladni::io
