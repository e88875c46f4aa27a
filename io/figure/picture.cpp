// Describes the contact sheet of modes for the painter.
#include "io/picture.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "io/bytes/message.h"
#include "io/figure/painted.h"
#include "io/figure/skin.h"
#include "mesh/surface.h"

namespace chladni::io {
namespace {

constexpr Eigen::Index kMostSheetVertices = 80'000;  // more are not visible at this size
constexpr double kDeformation = 0.06;                // of the body's diagonal
constexpr double kSteepest = 1.2;                    // change of displacement per length

// The axis with most of the motion.
Eigen::Index main_axis(const Points& shape) {
  Eigen::Index axis = 0;
  shape.colwise().squaredNorm().maxCoeff(&axis);
  return axis;
}

Eigen::Index nearest_vertex(const Points& points, const Eigen::Vector3d& at) {
  Eigen::Index nearest = 0;
  (points.rowwise() - at.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
  return nearest;
}

std::string note(Eigen::Index mode, Eigen::Index axis, const std::vector<fem::Cluster>& clusters) {
  std::string words = std::string("along ") + "xyz"[axis];
  for (const fem::Cluster& cluster : clusters) {
    if (mode < cluster.first || mode >= cluster.first + cluster.size) continue;
    words = (cluster.size == 2 ? "pair, " : fmt::format("one of {}, ", cluster.size)) + words;
  }
  return words;
}

// The factor for drawing a shape whose largest length is 1. The factor is below 1 where the shape
// would turn a part of a slim body by more than about 50 degrees.
double calm(const Skin& skin, const Points& at, const Points& shape) {
  const auto box = mesh::bounding_box(at);
  const double deformation = kDeformation * (box.row(1) - box.row(0)).norm();
  double steepest = 0.0;
  for (const auto t : skin.triangles.rowwise()) {
    for (const auto& [a, b] : mesh::kTriangleEdges) {
      const double length = (at.row(t(a)) - at.row(t(b))).norm();
      const double change = (shape.row(t(a)) - shape.row(t(b))).norm();
      if (length > 0.0) steepest = std::max(steepest, deformation * change / length);
    }
  }
  return steepest > kSteepest ? kSteepest / steepest : 1.0;
}

void add_panels(Message& request, const Skin& skin, const Points& at, const modal::Modes& modes,
                const std::vector<fem::Cluster>& clusters, int count) {
  const Eigen::Index panels = std::min<Eigen::Index>(count, modes.mode_count() - modes.rigid_count);
  auto& shapes = request.doubles["shapes"];
  shapes.resize(skin.vertex_count(), 3 * panels);
  JsonArray heads;
  for (Eigen::Index p = 0; p < panels; ++p) {
    const Eigen::Index mode = modes.rigid_count + p;
    Points shape = field_at(skin, modes.shapes.col(mode));
    const double largest = std::sqrt(shape.rowwise().squaredNorm().maxCoeff());
    if (largest > 0.0) shape *= calm(skin, at, shape / largest) / largest;
    shapes.middleCols<3>(3 * p) = shape;
    const Eigen::Index axis = main_axis(shape);
    heads.emplace_back(JsonObject{{"title", fmt::format("{} (flex {})   {:.2f} Hz", mode + 1, p + 1,
                                                        modes.frequency_hz(mode))},
                                  {"note", note(mode, axis, clusters)},
                                  {"axis", axis}});
  }
  request.head = JsonObject{{"kind", "contact_sheet"}, {"panels", std::move(heads)}};
}

}  // namespace

void draw_modes(const PictureFile& png, const mesh::TetMesh& mesh, const modal::Modes& modes,
                const std::string& title, const std::vector<Marker>& markers, int count,
                const std::vector<fem::Cluster>& clusters) {
  require(modes.shapes.rows() == 3 * mesh.node_count(),
          fmt::format("the modes have {} rows, expected 3 per node of the mesh: {}",
                      modes.shapes.rows(), 3 * mesh.node_count()));
  require(count >= 1 && modes.mode_count() > modes.rigid_count,
          "picture of the modes: there is no flexible mode to draw");
  const Skin body =
      decimated(smooth_skin(mesh, kMostSheetVertices), mesh.points, kMostSheetVertices);
  Message request;
  const Points at = vertices(body, mesh.points);
  add_panels(request, body, at, modes, clusters, count);
  request.doubles["points"] = at;
  request.integers["triangles"] = body.triangles;
  request.integers["outline"] = body.outline;
  Cells& vertex = request.integers["marker_vertex"];
  vertex.resize(static_cast<Eigen::Index>(markers.size()), 1);
  JsonArray kinds;
  for (Eigen::Index m = 0; m < vertex.rows(); ++m) {
    const Marker& marker = markers[static_cast<std::size_t>(m)];
    vertex(m) = static_cast<std::int32_t>(nearest_vertex(at, marker.position));
    kinds.emplace_back(JsonObject{{"name", marker.name}, {"kind", marker.kind}});
  }
  JsonObject head = std::get<JsonObject>(request.head.value());
  head.emplace_back("title", title);
  head.emplace_back("markers", std::move(kinds));
  head.emplace_back("deformation", kDeformation);
  request.head = Json(std::move(head));
  png.paint([request = std::move(request)] { return painted(request); });
}

}  // namespace chladni::io
