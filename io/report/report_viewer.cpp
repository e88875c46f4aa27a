// Shapes for the report's viewer, on few vertices and in few bytes.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "io/figure/skin.h"
#include "io/report_sections.h"
#include "mesh/surface.h"

namespace chladni::io {
namespace {

constexpr Eigen::Index kMostShapes = 64, kMostVertices = 20'000, kFewestVertices = 1'200;
constexpr double kFull = 32767.0;

std::vector<std::int16_t> quantised(const Points& values, double largest) {
  std::vector<std::int16_t> result;
  result.reserve(static_cast<std::size_t>(values.size()));
  const double scale = largest > 0.0 ? kFull / largest : 0.0;
  for (Eigen::Index v = 0; v < values.rows(); ++v) {
    for (Eigen::Index c = 0; c < 3; ++c) {
      result.push_back(
          static_cast<std::int16_t>(std::lround(std::clamp(scale * values(v, c), -kFull, kFull))));
    }
  }
  return result;
}

std::vector<std::uint16_t> packed(const Cells& cells) {
  std::vector<std::uint16_t> result;
  result.reserve(static_cast<std::size_t>(cells.size()));
  for (Eigen::Index c = 0; c < cells.rows(); ++c) {
    for (Eigen::Index k = 0; k < cells.cols(); ++k) {
      result.push_back(static_cast<std::uint16_t>(cells(c, k)));
    }
  }
  return result;
}

Viewer::Shape shape_of(const Skin& skin, const modal::Modes& modes, Eigen::Index mode) {
  const Points shape = field_at(skin, modes.shapes.col(mode));
  Eigen::Index axis = 0;
  shape.colwise().squaredNorm().maxCoeff(&axis);
  return {fmt::format("{} (flex {})   {:.2f} Hz", mode + 1, mode + 1 - modes.rigid_count,
                      modes.frequency_hz(mode)),
          quantised(shape, std::sqrt(shape.rowwise().squaredNorm().maxCoeff())),
          static_cast<int>(axis)};
}

// The number of vertices for `bytes`. A vertex takes four bytes per shape, six for the point and
// about twelve for the triangles. Base64 makes them a third longer.
Eigen::Index affordable(std::size_t bytes, Eigen::Index shapes) {
  const auto per_vertex = static_cast<std::size_t>(4 * shapes + 6 + 12) * 4 / 3;
  return std::clamp(static_cast<Eigen::Index>(bytes / per_vertex), kFewestVertices, kMostVertices);
}

}  // namespace

Viewer modes_viewer(const mesh::TetMesh& mesh, const modal::Modes& modes,
                    const std::vector<Marker>& markers, std::size_t bytes) {
  require(modes.shapes.rows() == 3 * mesh.node_count() && modes.shapes.cols() == modes.mode_count(),
          fmt::format("report: the shapes are {} x {}, expected {} x {}", modes.shapes.rows(),
                      modes.shapes.cols(), 3 * mesh.node_count(), modes.mode_count()));
  const Eigen::Index flexible = modes.mode_count() - modes.rigid_count;
  const Eigen::Index shown = std::min(flexible, kMostShapes);
  const Skin whole = skin(mesh, mesh.order());
  const Skin body = decimated(whole, mesh.points, affordable(bytes, shown));
  const Points at = vertices(body, mesh.points);
  const auto box = mesh::bounding_box(mesh.points);
  const Eigen::RowVector3d centre = 0.5 * (box.row(0) + box.row(1));

  Viewer viewer;
  viewer.points = quantised(at.rowwise() - centre, 0.5 * (box.row(1) - box.row(0)).norm());
  viewer.triangles = packed(body.triangles);
  viewer.outline = packed(body.outline);
  for (Eigen::Index k = 0; k < shown; ++k) {
    viewer.shapes.push_back(shape_of(body, modes, modes.rigid_count + k));
  }
  viewer.markers = markers;
  for (const Marker& marker : markers) {
    Eigen::Index nearest = 0;
    (at.rowwise() - marker.position.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
    viewer.marker_vertex.push_back(static_cast<std::uint16_t>(nearest));
  }
  if (body.vertex_count() < whole.vertex_count()) {
    viewer.note = fmt::format("Drawn on {} of the {} nodes of the surface; modes.vtu has them all.",
                              body.vertex_count(), whole.vertex_count());
  }
  if (shown < flexible) {
    viewer.note += fmt::format(" The first {} of {} flexible modes are shown.", shown, flexible);
  }
  return viewer;
}

}  // namespace chladni::io
