#include "io/figure/plot_curve.h"

#include <algorithm>
#include <cmath>

namespace chladni::io {
namespace {

using Path = Drawing::Path;
using Place = Eigen::Vector2d;

// The part of a segment inside the frame (Liang and Barsky 1984); false where there is none.
bool clip(const PlotFrame& frame, Place& a, Place& b) {
  const Place step = b - a;
  double from = 0.0, to = 1.0;
  for (int axis = 0; axis < 2; ++axis) {
    const double low = frame.corner(axis), high = low + frame.size(axis);
    if (step(axis) == 0.0) {
      if (a(axis) < low || a(axis) > high) return false;
      continue;
    }
    const double t1 = (low - a(axis)) / step(axis), t2 = (high - a(axis)) / step(axis);
    from = std::max(from, std::min(t1, t2));
    to = std::min(to, std::max(t1, t2));
  }
  if (from > to) return false;
  b = a + to * step;
  a += from * step;
  return true;
}

}  // namespace

std::vector<Path> plot_curve(const PlotFrame& frame, const Eigen::VectorXd& x,
                             const Eigen::VectorXd& y) {
  std::vector<Path> paths;
  Place last(std::nan(""), 0.0);
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    const Place point = frame.at(x(k), y(k));
    if (point.allFinite() && last.allFinite()) {
      if ((point - last).norm() < 0.2 && k + 1 < x.size()) continue;
      Place a = last, b = point;
      if (clip(frame, a, b)) {
        const bool goes_on = !paths.empty() && (paths.back().back() - a).norm() < 1e-6;
        if (!goes_on) paths.push_back({a});
        paths.back().push_back(b);
      }
    }
    last = point;
  }
  return paths;
}

std::vector<Path> dashed(const std::vector<Path>& paths, double stroke, double gap) {
  std::vector<Path> dashes;
  for (const auto& path : paths) {
    double left = stroke;
    bool on = true;
    if (path.size() > 1) dashes.push_back({path.front()});
    for (std::size_t p = 1; p < path.size(); ++p) {
      Place at = path[p - 1];
      while ((path[p] - at).norm() > left) {
        at += left * (path[p] - at).normalized();
        if (on) dashes.back().push_back(at);
        if (!on) dashes.push_back({at});
        on = !on;
        left = on ? stroke : gap;
      }
      left -= (path[p] - at).norm();
      if (on) dashes.back().push_back(path[p]);
    }
  }
  std::erase_if(dashes, [](const Path& dash) { return dash.size() < 2; });
  return dashes;
}

}  // namespace chladni::io
