#include "io/heat_map_picture.h"

#include <Eigen/Geometry>

#include "base/atomic_file.h"
#include "io/message.h"
#include "io/painted.h"
#include "io/view.h"

namespace chladni::io {
namespace {

// Rows: right, up and towards the eye. A surface that faces all ways is seen from above.
Eigen::Matrix3d paper_frame(const HeatMapPicture& picture) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double area = 0.0;
  for (const auto t : picture.triangles.rowwise()) {
    const Eigen::Vector3d a = picture.points.row(t(0));
    const Eigen::Vector3d b = picture.points.row(t(1));
    const Eigen::Vector3d c = picture.points.row(t(2));
    const Eigen::Vector3d twice = (b - a).cross(c - a);
    normal += twice;
    area += twice.norm();
  }
  const Eigen::Matrix3d pose = pose_of(picture.points).frame;
  if (normal.norm() < 0.3 * area) return pose;
  normal.normalize();
  Eigen::Vector3d right = pose.row(0).transpose();
  right -= right.dot(normal) * normal;
  if (right.norm() < 0.3) {
    right = pose.row(1).transpose();
    right -= right.dot(normal) * normal;
  }
  right.normalize();
  Eigen::Matrix3d frame;
  frame << right.transpose(), normal.cross(right).transpose(), normal.transpose();
  return frame;
}

void add_triangles(Message& request, const HeatMapPicture& picture) {
  std::vector<Eigen::Index> allowed, forbidden;
  for (Eigen::Index t = 0; t < picture.triangles.rows(); ++t) {
    bool free = true;
    for (const auto corner : picture.triangles.row(t)) {
      free = free && picture.forbidden[static_cast<std::size_t>(corner)] == 0;
    }
    (free ? allowed : forbidden).push_back(t);
  }
  request.integers["allowed"] = picture.triangles(allowed, Eigen::all);
  request.integers["forbidden"] = picture.triangles(forbidden, Eigen::all);
}

}  // namespace

void draw_heat_map(const std::filesystem::path& png, const HeatMapPicture& picture) {
  const Eigen::Matrix3d frame = paper_frame(picture);
  Message request;
  request.doubles["points"] = picture.points * frame.transpose();
  request.doubles["value"] = picture.value;
  add_triangles(request, picture);
  JsonArray lines, best, markers;
  auto& fields = request.doubles["lines"];
  fields.resize(picture.points.rows(), static_cast<Eigen::Index>(picture.nodal_lines.size()));
  for (std::size_t k = 0; k < picture.nodal_lines.size(); ++k) {
    lines.emplace_back(picture.nodal_lines[k].first);
    fields.col(static_cast<Eigen::Index>(k)) = picture.nodal_lines[k].second;
  }
  auto& places = request.doubles["best"];
  places.resize(static_cast<Eigen::Index>(picture.best.size()), 3);
  for (std::size_t k = 0; k < picture.best.size(); ++k) {
    best.emplace_back(picture.best[k].label);
    places.row(static_cast<Eigen::Index>(k)) = (frame * picture.best[k].position).transpose();
  }
  auto& channels = request.doubles["marker_places"];
  channels.resize(static_cast<Eigen::Index>(picture.markers.size()), 3);
  for (std::size_t k = 0; k < picture.markers.size(); ++k) {
    markers.emplace_back(
        JsonObject{{"name", picture.markers[k].name}, {"kind", picture.markers[k].kind}});
    channels.row(static_cast<Eigen::Index>(k)) = (frame * picture.markers[k].position).transpose();
  }
  request.head = JsonObject{{"kind", "heat_map"},         {"title", picture.title},
                            {"scale", picture.scale},     {"lowest", picture.lowest},
                            {"highest", picture.highest}, {"lines", std::move(lines)},
                            {"best", std::move(best)},    {"markers", std::move(markers)}};
  write_atomically(png, painted(request));
}

}  // namespace chladni::io
