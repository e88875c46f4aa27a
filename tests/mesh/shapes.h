// Surfaces that the tests of this room take apart.
#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "mesh/surface.h"

namespace chladni::mesh::shapes {

inline Surface surface_of(const std::vector<Eigen::RowVector3d>& points,
                          const std::vector<Eigen::RowVector3i>& triangles) {
  Surface surface;
  surface.points.resize(static_cast<Eigen::Index>(points.size()), 3);
  surface.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
  for (Eigen::Index i = 0; i < surface.points.rows(); ++i) {
    surface.points.row(i) = points[static_cast<std::size_t>(i)];
  }
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    surface.triangles.row(t) = triangles[static_cast<std::size_t>(t)];
  }
  surface.patch.setZero(surface.triangles.rows());
  surface.patch_names = {"all"};
  return surface;
}

/// Patches x_min, x_max, y_min, y_max, z_min, z_max of two triangles each.
inline Surface box(const Eigen::RowVector3d& low, const Eigen::RowVector3d& high) {
  std::vector<Eigen::RowVector3d> points;
  for (int i = 0; i < 8; ++i) {
    points.emplace_back((i & 1) != 0 ? high[0] : low[0], (i & 2) != 0 ? high[1] : low[1],
                        (i & 4) != 0 ? high[2] : low[2]);
  }
  Surface surface = surface_of(points, {{0, 4, 6},
                                        {0, 6, 2},
                                        {1, 3, 7},
                                        {1, 7, 5},
                                        {0, 1, 5},
                                        {0, 5, 4},
                                        {2, 6, 7},
                                        {2, 7, 3},
                                        {0, 2, 3},
                                        {0, 3, 1},
                                        {4, 5, 7},
                                        {4, 7, 6}});
  surface.patch_names = {"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"};
  for (Eigen::Index t = 0; t < 12; ++t) surface.patch[t] = static_cast<int>(t) / 2;
  return surface;
}

inline Surface cube(double edge = 1.0) { return box({0.0, 0.0, 0.0}, {edge, edge, edge}); }

/// Volume 1/6.
inline Surface tetrahedron() {
  return surface_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                    {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}});
}

/// Around z, `around` times `across` quadrangles of two triangles.
inline Surface torus(double ring_radius, double tube_radius, int around, int across) {
  std::vector<Eigen::RowVector3d> points;
  std::vector<Eigen::RowVector3i> triangles;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double u = 2.0 * std::numbers::pi * i / around;
      const double v = 2.0 * std::numbers::pi * j / across;
      const double r = ring_radius + tube_radius * std::cos(v);
      points.emplace_back(r * std::cos(u), r * std::sin(u), tube_radius * std::sin(v));
      const auto at = [&](int a, int b) { return (a % around) * across + b % across; };
      triangles.emplace_back(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      triangles.emplace_back(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return surface_of(points, triangles);
}

/// A regular prism about a line along z, patch "bore".
inline Surface prism(double x, double y, double radius, double bottom, double top, int sides) {
  std::vector<Eigen::RowVector3d> points{{x, y, bottom}, {x, y, top}};
  std::vector<Eigen::RowVector3i> triangles;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / sides;
    points.emplace_back(x + radius * std::cos(angle), y + radius * std::sin(angle), bottom);
    points.emplace_back(x + radius * std::cos(angle), y + radius * std::sin(angle), top);
    const int here = 2 + 2 * i;
    const int next = 2 + 2 * ((i + 1) % sides);
    triangles.emplace_back(0, next, here);
    triangles.emplace_back(1, here + 1, next + 1);
    triangles.emplace_back(here, next, next + 1);
    triangles.emplace_back(here, next + 1, here + 1);
  }
  Surface surface = surface_of(points, triangles);
  surface.patch_names = {"bore"};
  return surface;
}

/// All triangles of both, side by side; the patches of a.
inline Surface both(const Surface& a, const Surface& b) {
  Surface all = a;
  all.points.conservativeResize(a.points.rows() + b.points.rows(), 3);
  all.points.bottomRows(b.points.rows()) = b.points;
  all.triangles.conservativeResize(a.triangles.rows() + b.triangles.rows(), 3);
  all.triangles.bottomRows(b.triangles.rows()) =
      b.triangles.array() + static_cast<int>(a.points.rows());
  all.patch = Eigen::VectorXi::Zero(all.triangles.rows());
  all.patch.head(a.patch.size()) = a.patch;
  return all;
}

inline Surface moved(Surface surface, const Eigen::RowVector3d& by) {
  surface.points.rowwise() += by;
  return surface;
}

inline Surface scaled(Surface surface, double factor) {
  surface.points *= factor;
  return surface;
}

inline void turn(Surface& surface, Eigen::Index t) {
  std::swap(surface.triangles(t, 1), surface.triangles(t, 2));
}

/// Three points per triangle, as an STL file has them.
inline Surface as_soup(const Surface& surface) {
  Surface soup = surface;
  soup.points.resize(surface.triangles.size(), 3);
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    for (Eigen::Index k = 0; k < 3; ++k) {
      soup.points.row(3 * t + k) = surface.points.row(surface.triangles(t, k));
      soup.triangles(t, k) = static_cast<int>(3 * t + k);
    }
  }
  return soup;
}

inline double patch_area(const Points& points, const Cells& triangles, const Eigen::VectorXi& patch,
                         int wanted) {
  double area = 0.0;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    if (patch[t] != wanted) continue;
    const Eigen::RowVector3d a = points.row(triangles(t, 0));
    const Eigen::RowVector3d u = points.row(triangles(t, 1)) - a;
    const Eigen::RowVector3d v = points.row(triangles(t, 2)) - a;
    area += 0.5 * std::sqrt(u.squaredNorm() * v.squaredNorm() - std::pow(u.dot(v), 2));
  }
  return area;
}

}  // namespace chladni::mesh::shapes
