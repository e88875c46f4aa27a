#include "mesh/bodies.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "mesh/shapes/body_checks.h"
#include "mesh/shapes/brick_grid.h"

namespace chladni::mesh {
namespace {

// Lines from −half to half with cells of at most `edge_length`. Both ends get a cell of width
// `strip` where a strip is wanted and is narrower than the other cells.
std::vector<double> spread(double length, const Layering& layering) {
  const double half = length / 2.0;
  const double strip = layering.edge_strip;
  if (strip <= 0.0 || strip > 0.75 * layering.edge_length || strip > 0.2 * length) {
    return mirrored_lines(-half, {{half, cells_in(length, layering.edge_length)}});
  }
  return mirrored_lines(-half,
                        {{-half + strip, 1},
                         {half - strip, cells_in(length - 2.0 * strip, layering.edge_length)},
                         {half, 1}});
}

BrickGrid grid_of(const Plate& plate, const Layering& layering) {
  return BrickGrid::block(spread(plate.length, layering), spread(plate.width, layering),
                          lines(-plate.thickness, {{0.0, layering.layers}}));
}

void require_convex(const Quadrilateral& plate) {
  require_positive("quadrilateral", "thickness", plate.thickness);
  require(plate.corners.allFinite(), "quadrilateral: a corner is not finite");
  for (int c = 0; c < 4; ++c) {
    const Eigen::RowVector2d in = plate.corners.row((c + 1) % 4) - plate.corners.row(c);
    const Eigen::RowVector2d out = plate.corners.row((c + 2) % 4) - plate.corners.row((c + 1) % 4);
    const double turn = in(0) * out(1) - in(1) * out(0);
    require(turn > 1e-9 * in.norm() * out.norm(),
            "quadrilateral: corner " + fmt::to_string((c + 1) % 4 + 1) +
                " does not turn left; expected a convex one, counter-clockwise from above");
  }
}

// Maps a point of the cube |x|, |y|, |z| <= 1 to the ball. The shell max(|x|, |y|, |z|) = r becomes
// the sphere of radius r, divided by planes at equal angles.
Eigen::RowVector3d on_ball(const Eigen::RowVector3d& cube) {
  const double shell = cube.cwiseAbs().maxCoeff();
  if (shell == 0.0) return cube;
  const Eigen::RowVector3d spread =
      (cube / shell * (std::numbers::pi / 4.0)).array().tan().matrix();
  return shell * spread.normalized();
}

// Cells along half an edge of the cube, so that no curved edge of the hole bends over the straight
// edges of its wall of `shells` cells: the diagonal of a cell spans √2 π/4 over their number at
// most, about, and rises by less than an eighth of a shell.
int half_around(const Sphere& sphere, int shells) {
  constexpr double kThinnest = 5.3e-4;  // of what a grid of 2 million bricks holds
  const double outer = sphere.diameter / 2.0;
  const double wall = outer - sphere.hole_diameter / 2.0;
  require(wall >= kThinnest * outer,
          fmt::format("sphere: a wall of {:.3g} mm on a radius of {:.3g} mm is too thin to be laid "
                      "in layers; expected at least {:.3g} mm",
                      1e3 * wall, 1e3 * outer, 1e3 * kThinnest * outer));
  return static_cast<int>(std::ceil(std::sqrt(2.0 * outer * shells / wall)));
}

}  // namespace

Surface surface(const Plate& plate) {
  require_fit(plate);
  return surface(BrickGrid::block({-plate.length / 2.0, plate.length / 2.0},
                                  {-plate.width / 2.0, plate.width / 2.0},
                                  {-plate.thickness, 0.0}));
}

TetMesh layered(const Plate& plate, const Layering& layering) {
  require_fit(plate);
  require_fit(layering);
  return tetrahedra(grid_of(plate, layering));
}

TetMesh layered(const Quadrilateral& plate, const Layering& layering) {
  require_convex(plate);
  require_fit(layering);
  const auto side = [&](int a, int b) {
    return (plate.corners.row(a) - plate.corners.row(b)).norm();
  };
  TetMesh mesh = tetrahedra(grid_of({.length = std::max(side(0, 1), side(3, 2)),
                                     .width = std::max(side(1, 2), side(0, 3)),
                                     .thickness = plate.thickness},
                                    layering));
  const Eigen::Array2d half = mesh.points.leftCols(2).colwise().maxCoeff().transpose();
  for (auto point : mesh.points.rowwise()) {
    const double u = point(0) / half(0);
    const double v = point(1) / half(1);
    const Eigen::RowVector4d weights = Eigen::RowVector4d((1 - u) * (1 - v), (1 + u) * (1 - v),
                                                          (1 + u) * (1 + v), (1 - u) * (1 + v)) /
                                       4.0;
    point.leftCols(2) = weights * plate.corners;
  }
  return mesh;
}

TetMesh layered(const Sphere& sphere, double edge_length) {
  require_fit(sphere);
  require_positive("layered sphere", "edge length", edge_length);
  const double outer = sphere.diameter / 2.0;
  const double inner = sphere.hole_diameter / 2.0;
  const int shells = cells_in(outer - inner, edge_length);
  const int core =
      inner > 0.0 ? std::max(cells_in(inner, edge_length), half_around(sphere, shells) - shells)
                  : 0;
  const int half = core + shells;
  const auto line = mirrored_lines(-1.0, {{0.0, half}, {1.0, half}});
  BrickGrid grid = BrickGrid::block(line, line, line);
  grid.void_patch = {"inner"};
  for (int k = half - core; k < half + core; ++k) {
    for (int j = half - core; j < half + core; ++j) {
      for (int i = half - core; i < half + core; ++i) grid.kind[grid.brick(i, j, k)] = 1;
    }
  }
  TetMesh mesh = tetrahedra(grid);
  const double hole = static_cast<double>(core) / half;
  for (auto point : mesh.points.rowwise()) {
    const Eigen::RowVector3d at = on_ball(point);
    const double shell = at.norm();
    if (shell == 0.0) continue;
    point = at / shell *
            (core == 0 ? outer * shell : inner + (outer - inner) * (shell - hole) / (1.0 - hole));
  }
  const int sides = core > 0 ? static_cast<int>(mesh.patch_names.size()) - 1 : 0;
  for (int& patch : mesh.face_patch) patch = core > 0 && patch == sides ? 1 : 0;
  mesh.patch_names =
      core > 0 ? std::vector<std::string>{"outer", "inner"} : std::vector<std::string>{"outer"};
  return mesh;
}

Surface surface(const Sphere& sphere, double edge_length) {
  return boundary_surface(layered(sphere, edge_length));
}

void project_to_sphere(TetMesh& mesh, const Sphere& sphere) {
  require_fit(sphere);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const bool outer = mesh.patch_names[static_cast<std::size_t>(mesh.face_patch(f))] == "outer";
    const double radius = (outer ? sphere.diameter : sphere.hole_diameter) / 2.0;
    for (const std::int32_t node : mesh.faces.row(f)) {
      mesh.points.row(node) *= radius / mesh.points.row(node).norm();
    }
  }
}

}  // namespace chladni::mesh
