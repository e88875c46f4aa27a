#include "stage/diagnosis_faces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "stage/faces.h"

namespace chladni::stage {
namespace {

constexpr double kAlongAxis = 5.0;  // degrees
constexpr double kOneWay = 0.5;     // of the areas' sum; with less, they look in all directions

// Per boundary face 1 if its patch is in `patches`.
std::vector<char> faces_in(const mesh::TetMesh& body, const std::vector<std::string>& patches) {
  std::vector<char> chosen(static_cast<std::size_t>(body.faces.rows()), 0);
  for (std::size_t f = 0; f < chosen.size(); ++f) {
    const auto patch = static_cast<std::size_t>(body.face_patch(static_cast<Eigen::Index>(f)));
    chosen[f] = std::ranges::count(patches, body.patch_names[patch]) > 0 ? 1 : 0;
  }
  return chosen;
}

// The mean outward normal; none if the faces look in all directions.
std::optional<Eigen::Vector3d> mean_normal(const mesh::TetMesh& body,
                                           const std::vector<char>& chosen) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double area = 0.0;
  for (std::size_t f = 0; f < chosen.size(); ++f) {
    if (chosen[f] == 0) continue;
    const auto face = body.faces.row(static_cast<Eigen::Index>(f));
    const Eigen::Vector3d a = body.points.row(face(0));
    const Eigen::Vector3d b = body.points.row(face(1));
    const Eigen::Vector3d c = body.points.row(face(2));
    const Eigen::Vector3d twice = (b - a).cross(c - a);
    sum += twice;
    area += twice.norm();
  }
  if (!(sum.norm() > kOneWay * area)) return std::nullopt;
  const Eigen::Vector3d normal = sum.normalized();
  for (int k = 0; k < 3; ++k) {
    const double nearly = std::cos(kAlongAxis * std::numbers::pi / 180.0);
    if (std::abs(normal(k)) >= nearly)
      return std::copysign(1.0, normal(k)) * Eigen::Vector3d::Unit(k);
  }
  return normal;
}

}  // namespace

DiagnosedFaces diagnosed_faces(const study::Study& study, const mesh::TetMesh& body) {
  const study::FacePlan on = study.diagnosis ? study.diagnosis->on : study::FacePlan{};
  Faces faces = faces_of(study, body, on, "diagnosis.on");
  DiagnosedFaces result;
  result.notes = std::move(faces.notes);
  // Attachments on or below a wafer are seen on its top. A table without a wafer has no such patch.
  if (on.empty() && !faces.patches.empty()) faces.patches.emplace_back("wafer_top");
  result.chosen = faces.patches.empty() ? std::move(faces.looking) : faces_in(body, faces.patches);
  const auto normal = faces.direction ? faces.direction : mean_normal(body, result.chosen);
  result.chart = normal ? chart_along(body, *normal) : chart_of(body);
  return result;
}

bool has_the_axes_of_variations(const Chart& chart, const mesh::TetMesh& body) {
  return chart.axes.isApprox(chart_of(body).axes, 1e-9);
}

}  // namespace chladni::stage
