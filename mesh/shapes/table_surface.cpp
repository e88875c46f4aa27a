// Tables as closed surfaces, with bores and a wafer, which bricks cannot represent.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "mesh/bodies.h"
#include "mesh/check.h"
#include "mesh/shapes/body_checks.h"
#include "mesh/shapes/brick_grid.h"
#include "mesh/shapes/table.h"

namespace chladni::mesh {
namespace {

// A bore as a regular prism of the same area. It reaches beyond the table where the bore is open.
Surface bore_body(const Bore& bore, double height, double edge_length) {
  const double around = std::numbers::pi * bore.diameter;
  const int sides = std::clamp(cells_in(around, edge_length), 24, 96);
  const double angle = 2.0 * std::numbers::pi / sides;
  const double radius = bore.diameter / 2.0 * std::sqrt(angle / std::sin(angle));
  const double low = -1.5 * height;
  const double high = bore.depth > 0.0 ? bore.depth - height : 0.5 * height;
  Surface body;
  body.points.resize(2 * sides + 2, 3);
  for (int s = 0; s < sides; ++s) {
    const Eigen::Vector2d at = bore.centre + radius * Eigen::Vector2d(std::cos(angle * (s + 0.5)),
                                                                      std::sin(angle * (s + 0.5)));
    body.points.row(s) << at.x(), at.y(), low;
    body.points.row(sides + s) << at.x(), at.y(), high;
  }
  body.points.row(2 * sides) << bore.centre.x(), bore.centre.y(), low;
  body.points.row(2 * sides + 1) << bore.centre.x(), bore.centre.y(), high;
  body.triangles.resize(4 * sides, 3);
  for (int s = 0; s < sides; ++s) {
    const int next = (s + 1) % sides;
    body.triangles.row(4 * s) << s, next, sides + next;
    body.triangles.row(4 * s + 1) << s, sides + next, sides + s;
    body.triangles.row(4 * s + 2) << 2 * sides, next, s;
    body.triangles.row(4 * s + 3) << 2 * sides + 1, sides + s, sides + next;
  }
  body.patch = Eigen::VectorXi::Zero(body.triangles.rows());
  body.patch_names = {"bores"};
  return body;
}

Surface wafer_on_top(const WaferTable& table, double edge_length) {
  Surface wafer = surface(
      Disc{.diameter = table.wafer_diameter, .thickness = table.wafer_thickness}, edge_length);
  wafer.points.col(2).array() += table.wafer_thickness;
  for (std::string& name : wafer.patch_names) name = "wafer_" + name;
  return wafer;
}

}  // namespace

Surface surface(const WaferTable& table, double edge_length) {
  require_fit(table);
  require_positive("wafer table", "edge length", edge_length);
  // The triangles are as large as the parts allow. The mesher makes them regular later.
  Surface body = surface(grid_of(table, {.edge_length = std::max(table.length, table.width)}));
  for (const Bore& bore : table.bores) {
    body = difference(body, bore_body(bore, table.height, edge_length));
  }
  if (table.wafer_diameter > 0.0) {
    body = bonded(body, wafer_on_top(table, edge_length), "body", "wafer");
  }
  return body;
}

}  // namespace chladni::mesh
