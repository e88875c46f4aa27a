#include "io/heat_map_picture.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <utility>

#include "io/bytes/message.h"
#include "io/figure/painted.h"
#include "io/figure/view.h"

namespace chladni::io {
namespace {

// Rows: right, up and towards the eye. A surface without a mean normal is seen from above.
Eigen::Matrix3d paper_frame(const Points& points, const Cells& triangles) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double area = 0.0;
  for (const auto t : triangles.rowwise()) {
    const Eigen::Vector3d a = points.row(t(0));
    const Eigen::Vector3d b = points.row(t(1));
    const Eigen::Vector3d c = points.row(t(2));
    const Eigen::Vector3d twice = (b - a).cross(c - a);
    normal += twice;
    area += twice.norm();
  }
  const Eigen::Matrix3d pose = pose_of(points).frame;
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

Message::Doubles places_of(const std::vector<Marker>& markers, const Eigen::Matrix3d& frame) {
  Message::Doubles places(static_cast<Eigen::Index>(markers.size()), 3);
  for (std::size_t k = 0; k < markers.size(); ++k) {
    places.row(static_cast<Eigen::Index>(k)) = (frame * markers[k].position).transpose();
  }
  return places;
}

Json marker_json(const Marker& marker) {
  return JsonObject{{"name", marker.name}, {"kind", marker.kind}};
}

}  // namespace

void draw_heat_map(const PictureFile& png, const HeatMapPicture& picture) {
  const Eigen::Matrix3d frame = paper_frame(picture.points, picture.triangles);
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
  request.doubles["marker_places"] = places_of(picture.markers, frame);
  for (const auto& marker : picture.markers) markers.emplace_back(marker_json(marker));
  request.head = JsonObject{
      {"kind", "heat_map"},       {"title", picture.title},     {"scale", picture.scale},
      {"lowest", picture.lowest}, {"highest", picture.highest}, {"lines", std::move(lines)},
      {"best", std::move(best)},  {"star", picture.star},       {"markers", std::move(markers)}};
  png.paint([request = std::move(request)] { return painted(request); });
}

void draw_layouts(const PictureFile& png, const LayoutsPicture& picture) {
  const Eigen::Matrix3d frame = paper_frame(picture.points, picture.triangles);
  Message request;
  request.doubles["points"] = picture.points * frame.transpose();
  request.integers["triangles"] = picture.triangles;
  auto& values = request.doubles["values"];
  values.resize(picture.points.rows(), static_cast<Eigen::Index>(picture.panels.size()));
  JsonArray panels;
  for (std::size_t p = 0; p < picture.panels.size(); ++p) {
    const auto& panel = picture.panels[p];
    values.col(static_cast<Eigen::Index>(p)) = panel.value;
    JsonArray kinds;
    for (const auto& marker : panel.markers) kinds.emplace_back(marker.kind);
    request.doubles["places_" + fmt::to_string(p)] = places_of(panel.markers, frame);
    panels.emplace_back(
        JsonObject{{"title", panel.title}, {"note", panel.note}, {"kinds", std::move(kinds)}});
  }
  request.head = JsonObject{{"kind", "layouts"},          {"title", picture.title},
                            {"scale", picture.scale},     {"lightest", picture.lightest},
                            {"darkest", picture.darkest}, {"panels", std::move(panels)}};
  png.paint([request = std::move(request)] { return painted(request); });
}

}  // namespace chladni::io
