#include "mesh/shapes/brick_grid.h"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "base/error.h"

namespace chladni::mesh {
namespace {

using Lattice = std::array<int, 3>;  // line numbers along x, y, z

constexpr std::array<const char*, 6> kSides{"x_min", "x_max", "y_min", "y_max", "bottom", "top"};

// Used lattice points, numbered in the order of their first use.
class Vertices {
 public:
  explicit Vertices(const BrickGrid& grid)
      : grid_(grid), number_(grid.x.size() * grid.y.size() * grid.z.size(), -1) {}

  std::int32_t number(const Lattice& at) {
    const auto i = static_cast<std::size_t>(at[0]);
    const auto j = static_cast<std::size_t>(at[1]);
    const auto k = static_cast<std::size_t>(at[2]);
    std::int32_t& number = number_[(k * grid_.y.size() + j) * grid_.x.size() + i];
    if (number < 0) {
      number = static_cast<std::int32_t>(used_.size());
      used_.emplace_back(grid_.x[i], grid_.y[j], grid_.z[k]);
    }
    return number;
  }

  [[nodiscard]] Points points() const {
    Points points(static_cast<Eigen::Index>(used_.size()), 3);
    for (std::size_t p = 0; p < used_.size(); ++p) {
      points.row(static_cast<Eigen::Index>(p)) = used_[p];
    }
    return points;
  }

 private:
  const BrickGrid& grid_;
  std::vector<std::int32_t> number_;
  std::vector<Eigen::Vector3d> used_;
};

template <typename Visit>
void for_each_filled(const BrickGrid& grid, const Visit& visit) {
  for (int k = 0; k + 1 < static_cast<int>(grid.z.size()); ++k) {
    for (int j = 0; j + 1 < static_cast<int>(grid.y.size()); ++j) {
      for (int i = 0; i + 1 < static_cast<int>(grid.x.size()); ++i) {
        if (grid.kind[grid.brick(i, j, k)] == 0) visit(Lattice{i, j, k});
      }
    }
  }
}

// The patch of a side of a filled brick: 0 ... 5 as in kSides, then the voids; -1 where the
// neighbour is filled.
int patch_of_side(const BrickGrid& grid, Lattice brick, std::size_t axis, int side) {
  const std::array<std::size_t, 3> bricks{grid.x.size() - 1, grid.y.size() - 1, grid.z.size() - 1};
  brick[axis] += side == 0 ? -1 : 1;
  if (brick[axis] < 0 || brick[axis] == static_cast<int>(bricks[axis])) {
    return static_cast<int>(2 * axis) + side;
  }
  const int kind = grid.kind[grid.brick(brick[0], brick[1], brick[2])];
  return kind == 0 ? -1 : 5 + kind;
}

// The two triangles of a side, outward. The diagonal joins the corners of equal parities.
std::array<std::array<Lattice, 3>, 2> side_triangles(const Lattice& brick, std::size_t axis,
                                                     int side) {
  const std::size_t b = (axis + 1) % 3;
  const std::size_t c = (axis + 2) % 3;
  std::array<Lattice, 4> q;  // counter-clockwise seen from +axis
  q.fill(brick);
  for (Lattice& corner : q) corner[axis] += side;
  ++q[1][b];
  ++q[2][b];
  ++q[2][c];
  ++q[3][c];
  if ((brick[b] + brick[c]) % 2 != 0) q = {q[1], q[2], q[3], q[0]};
  if (side == 0) std::swap(q[1], q[3]);
  return {{{q[0], q[1], q[2]}, {q[0], q[2], q[3]}}};
}

struct Boundary {
  Cells triangles;
  Eigen::VectorXi patch;
  std::vector<std::string> patch_names;
};

// Adds the patch names. Only patches that have a triangle get a name.
Boundary with_names(const std::vector<std::array<std::int32_t, 3>>& triangles,
                    const std::vector<int>& patch, const BrickGrid& grid) {
  std::vector<std::string> names(kSides.begin(), kSides.end());
  names.insert(names.end(), grid.void_patch.begin(), grid.void_patch.end());
  std::vector<int> number(names.size(), -1);
  for (const int p : patch) number[static_cast<std::size_t>(p)] = 0;
  Boundary result;
  for (const std::size_t p : {5, 4, 0, 1, 2, 3}) {  // top and bottom first
    if (number[p] < 0) continue;
    number[p] = static_cast<int>(result.patch_names.size());
    result.patch_names.push_back(names[p]);
  }
  for (std::size_t p = 6; p < names.size(); ++p) {
    if (number[p] < 0) continue;
    number[p] = static_cast<int>(result.patch_names.size());
    result.patch_names.push_back(names[p]);
  }
  result.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
  result.patch.resize(result.triangles.rows());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto row = static_cast<Eigen::Index>(t);
    for (std::size_t a = 0; a < 3; ++a) {
      result.triangles(row, static_cast<Eigen::Index>(a)) = triangles[t][a];
    }
    result.patch(row) = number[static_cast<std::size_t>(patch[t])];
  }
  return result;
}

Boundary boundary(const BrickGrid& grid, Vertices& vertices) {
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<int> patches;
  for_each_filled(grid, [&](const Lattice& brick) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const int side : {0, 1}) {
        const int patch = patch_of_side(grid, brick, axis, side);
        if (patch < 0) continue;
        for (const auto& [a, b, c] : side_triangles(brick, axis, side)) {
          triangles.push_back({vertices.number(a), vertices.number(b), vertices.number(c)});
          patches.push_back(patch);
        }
      }
    }
  });
  return with_names(triangles, patches, grid);
}

// The six tetrahedra of a brick. Each starts at the corner with even line numbers and takes one
// step along each axis, in one of the six orders of axes.
std::array<std::array<Lattice, 4>, 6> kuhn_simplices(const Lattice& brick) {
  constexpr std::array<std::array<std::size_t, 3>, 6> kOrders{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};  // three even, three odd
  Lattice even = brick;
  Lattice step{1, 1, 1};
  bool mirrored = false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (brick[axis] % 2 == 0) continue;
    ++even[axis];
    step[axis] = -1;
    mirrored = !mirrored;
  }
  std::array<std::array<Lattice, 4>, 6> tets;
  for (std::size_t t = 0; t < 6; ++t) {
    tets[t][0] = even;
    for (std::size_t s = 0; s < 3; ++s) {
      tets[t][s + 1] = tets[t][s];
      tets[t][s + 1][kOrders[t][s]] += step[kOrders[t][s]];
    }
    if (mirrored != (t >= 3)) std::swap(tets[t][1], tets[t][2]);
  }
  return tets;
}

constexpr double kMostBricks = 2e6;  // half a minute and 2 GB beside K and M

}  // namespace

BrickGrid BrickGrid::block(std::vector<double> x, std::vector<double> y, std::vector<double> z) {
  const double bricks = static_cast<double>(x.size() - 1) * static_cast<double>(y.size() - 1) *
                        static_cast<double>(z.size() - 1);
  require(
      bricks <= kMostBricks,
      fmt::format("mesh: {:.3g} million bricks of six tetrahedra, at most {:.0f} million can be "
                  "laid; take a longer edge length, or look at the unit of the dimensions",
                  1e-6 * bricks, 1e-6 * kMostBricks));
  BrickGrid grid;
  grid.kind.assign((x.size() - 1) * (y.size() - 1) * (z.size() - 1), 0);
  grid.x = std::move(x);
  grid.y = std::move(y);
  grid.z = std::move(z);
  return grid;
}

std::size_t BrickGrid::brick(int i, int j, int k) const {
  return (static_cast<std::size_t>(k) * (y.size() - 1) + static_cast<std::size_t>(j)) *
             (x.size() - 1) +
         static_cast<std::size_t>(i);
}

std::vector<double> lines(double begin, const std::vector<Stretch>& stretches) {
  std::vector<double> result{begin};
  for (const auto& [end, cells] : stretches) {
    const double from = result.back();
    for (int c = 1; c < cells; ++c) result.push_back(from + (end - from) * c / cells);
    result.push_back(end);
  }
  return result;
}

std::vector<double> mirrored_lines(double begin, std::vector<Stretch> stretches) {
  const double nothing = -1e-9 * begin;
  double from = begin;
  for (Stretch& stretch : stretches) {
    const bool across = from < -nothing && stretch.end > nothing;
    if (across && stretch.cells % 2 != 0) ++stretch.cells;
    from = stretch.end;
  }
  const std::vector<double> once = lines(begin, stretches);
  std::vector<double> result(once.size());
  for (std::size_t i = 0; i < once.size(); ++i) {
    result[i] = (once[i] - once[once.size() - 1 - i]) / 2.0;
  }
  return result;
}

Surface surface(const BrickGrid& grid) {
  Vertices vertices(grid);
  Boundary outside = boundary(grid, vertices);
  Surface result;
  result.triangles = std::move(outside.triangles);
  result.patch = std::move(outside.patch);
  result.patch_names = std::move(outside.patch_names);
  result.points = vertices.points();
  return result;
}

TetMesh tetrahedra(const BrickGrid& grid) {
  Vertices vertices(grid);
  std::vector<std::int32_t> corners;
  for_each_filled(grid, [&](const Lattice& brick) {
    for (const auto& tet : kuhn_simplices(brick)) {
      for (const Lattice& at : tet) corners.push_back(vertices.number(at));
    }
  });
  TetMesh result;
  result.tets =
      Eigen::Map<const Cells>(corners.data(), static_cast<Eigen::Index>(corners.size() / 4), 4);
  result.region = Eigen::VectorXi::Zero(result.tets.rows());
  result.region_names = {"body"};
  Boundary outside = boundary(grid, vertices);
  result.faces = std::move(outside.triangles);
  result.face_patch = std::move(outside.patch);
  result.patch_names = std::move(outside.patch_names);
  result.points = vertices.points();
  return result;
}

}  // namespace chladni::mesh
