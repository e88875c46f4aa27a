#include "io/figure/seen_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "mesh/surface.h"

namespace chladni::io {
namespace {

constexpr double kNearlyMost = 0.9;

// The part that is nearest to the eye at each pixel; y points up.
struct Paper {
  Eigen::Vector2d corner;
  double pixel = 1.0;  // [m]
  Eigen::MatrixXi part;
  Eigen::MatrixXd height;

  Paper(const Points& points, int pixels) {
    const auto box = mesh::bounding_box(points);
    const Eigen::Vector2d size = (box.row(1) - box.row(0)).head<2>().transpose();
    pixel = std::max(size.maxCoeff() / pixels, 1e-300);
    corner = box.row(0).head<2>().transpose().array() - pixel;  // a rim of one pixel
    const Eigen::Vector2i count = (size / pixel).array().ceil().cast<int>() + 2;
    part = Eigen::MatrixXi::Constant(count(0), count(1), -1);
    height =
        Eigen::MatrixXd::Constant(count(0), count(1), -std::numeric_limits<double>::infinity());
  }

  // The first and the last pixel whose centre may lie between `low` and `high`.
  [[nodiscard]] std::pair<Eigen::Index, Eigen::Index> range(double low, double high,
                                                            int axis) const {
    const double last = static_cast<double>(axis == 0 ? part.rows() : part.cols()) - 1.0;
    const auto clamped = [&](double x) {
      return static_cast<Eigen::Index>(std::clamp(x, 0.0, last));
    };
    return {clamped(std::floor((low - corner(axis)) / pixel - 0.5)),
            clamped(std::ceil((high - corner(axis)) / pixel - 0.5))};
  }

  [[nodiscard]] Eigen::Vector2d centre(Eigen::Index i, Eigen::Index j) const {
    return corner +
           pixel * Eigen::Vector2d(static_cast<double>(i) + 0.5, static_cast<double>(j) + 0.5);
  }

  void paint(const Eigen::Matrix3d& corners, int number) {
    const Eigen::Vector2d a = corners.row(0).head<2>();
    Eigen::Matrix2d edges;
    edges << (corners.row(1) - corners.row(0)).head<2>().transpose(),
        (corners.row(2) - corners.row(0)).head<2>().transpose();
    const double twice = edges.determinant();
    if (std::abs(twice) < 1e-12 * pixel * pixel) return;
    const Eigen::Matrix2d inverse = edges.inverse();
    const auto [i0, i1] = range(corners.col(0).minCoeff(), corners.col(0).maxCoeff(), 0);
    const auto [j0, j1] = range(corners.col(1).minCoeff(), corners.col(1).maxCoeff(), 1);
    for (Eigen::Index j = j0; j <= j1; ++j) {
      for (Eigen::Index i = i0; i <= i1; ++i) {
        const Eigen::Vector2d at = centre(i, j);
        const Eigen::Vector2d l = inverse * (at - a);
        if (l.minCoeff() < -1e-9 || l.sum() > 1.0 + 1e-9) continue;
        const double z =
            (1.0 - l.sum()) * corners(0, 2) + l(0) * corners(1, 2) + l(1) * corners(2, 2);
        if (z <= height(i, j)) continue;
        height(i, j) = z;
        part(i, j) = number;
      }
    }
  }
};

// The distance of each pixel from the nearest pixel of another part, in pixels, by two passes over
// the picture (Borgefors 1986, with steps of 3/3 and 4/3 of a pixel).
Eigen::MatrixXd depth_of(const Eigen::MatrixXi& part) {
  Eigen::MatrixXd depth = Eigen::MatrixXd::Zero(part.rows(), part.cols());
  const auto pass = [&](bool forward) {
    const Eigen::Index way = forward ? 1 : -1;
    for (Eigen::Index n = 1; n + 1 < part.cols(); ++n) {
      const Eigen::Index j = forward ? n : part.cols() - 1 - n;
      for (Eigen::Index m = 1; m + 1 < part.rows(); ++m) {
        const Eigen::Index i = forward ? m : part.rows() - 1 - m;
        if (part(i, j) < 0) continue;
        double least = forward ? std::numeric_limits<double>::infinity() : depth(i, j);
        const auto look = [&](Eigen::Index di, Eigen::Index dj, double step) {
          const bool same = part(i + di, j + dj) == part(i, j);
          least = std::min(least, same ? depth(i + di, j + dj) + step : 0.5 * step);
        };
        look(-way, 0, 1.0);
        look(0, -way, 1.0);
        look(-way, -way, 4.0 / 3.0);
        look(way, -way, 4.0 / 3.0);
        depth(i, j) = least;
      }
    }
  };
  pass(true);
  pass(false);
  return depth;
}

// The best place of each part. A strip has many places with nearly the most room, so the place
// nearest to the middle of the visible area is taken.
std::vector<SeenPart> best_places(const Paper& paper, int parts) {
  const Eigen::MatrixXd depth = depth_of(paper.part);
  std::vector<SeenPart> seen(static_cast<std::size_t>(parts));
  std::vector<Eigen::Vector2d> middle(seen.size(), Eigen::Vector2d::Zero());
  std::vector<double> nearest(seen.size(), std::numeric_limits<double>::infinity());
  const auto each = [&](const auto& visit) {
    for (Eigen::Index j = 0; j < depth.cols(); ++j) {
      for (Eigen::Index i = 0; i < depth.rows(); ++i) {
        if (paper.part(i, j) >= 0) {
          visit(static_cast<std::size_t>(paper.part(i, j)), paper.centre(i, j), depth(i, j));
        }
      }
    }
  };
  each([&](std::size_t p, const Eigen::Vector2d& at, double room) {
    seen[p].area += paper.pixel * paper.pixel;
    seen[p].radius = std::max(seen[p].radius, paper.pixel * room);
    middle[p] += paper.pixel * paper.pixel * at;
  });
  each([&](std::size_t p, const Eigen::Vector2d& at, double room) {
    if (paper.pixel * room < kNearlyMost * seen[p].radius) return;
    const double off = (at - middle[p] / seen[p].area).norm();
    if (off >= nearest[p]) return;
    nearest[p] = off;
    seen[p].at = at;
  });
  return seen;
}

}  // namespace

std::vector<SeenPart> seen_parts(const Points& points, const Cells& triangles,
                                 const Eigen::VectorXi& part, int parts, int pixels) {
  require(part.size() == triangles.rows() && pixels >= 2 && points.rows() > 0 &&
              (part.size() == 0 || (part.minCoeff() >= 0 && part.maxCoeff() < parts)),
          "parts of a surface: the arrays do not fit together");
  Paper paper(points, pixels);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    Eigen::Matrix3d corners;
    for (Eigen::Index k = 0; k < 3; ++k) corners.row(k) = points.row(triangles(t, k));
    paper.paint(corners, part(t));
  }
  return best_places(paper, parts);
}

}  // namespace chladni::io
