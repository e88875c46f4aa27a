#include "placement/sites.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <span>

#include "base/error.h"
#include "base/interrupt.h"
#include "host/parallel.h"
#include "mesh/faces.h"
#include "mesh/surface.h"
#include "placement/constants.h"

namespace chladni::placement {
namespace {

enum class PointsPer { node, node_and_patch };

// How far from a vertical line a place of a face that does not look up may be found, relative to
// the body: the search leaves some 1e-8.
constexpr double kOnLine = 1e-6;

// Number of wanted faces of each patch.
std::vector<int> face_counts(const mesh::TetMesh& body, const std::vector<char>& wanted) {
  std::vector<int> counts(body.patch_names.size(), 0);
  for (Eigen::Index f = 0; f < body.faces.rows(); ++f) {
    if (wanted[static_cast<std::size_t>(f)] != 0) {
      ++counts[static_cast<std::size_t>(body.face_patch(f))];
    }
  }
  return counts;
}

void require_marks(const mesh::TetMesh& body, const std::vector<char>& faces) {
  require(std::ssize(faces) == body.faces.rows(), "placement: " + fmt::to_string(faces.size()) +
                                                      " faces are marked, the body has " +
                                                      fmt::to_string(body.faces.rows()));
}

using NodeAndPatch = std::pair<int, int>;

void put(const mesh::TetMesh& body, const std::vector<NodeAndPatch>& points,
         const std::vector<Eigen::RowVector3i>& triangles, Surface& surface) {
  const auto count = static_cast<Eigen::Index>(points.size());
  surface.node.resize(count);
  surface.sites.patch.resize(count);
  surface.sites.position.resize(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto [node, patch] = points[static_cast<std::size_t>(i)];
    surface.node(i) = node;
    surface.sites.patch(i) = patch;
    surface.sites.position.row(i) = body.points.row(node);
  }
  surface.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    surface.triangles.row(static_cast<Eigen::Index>(t)) = triangles[t];
  }
}

// Makes points per node (and patch), and the triangles between them. A node on the border of two
// patches belongs to the smaller one.
void lay_out(const mesh::TetMesh& body, const std::vector<char>& wanted, PointsPer per,
             Surface& surface) {
  const auto size = face_counts(body, wanted);
  std::map<NodeAndPatch, int> number;
  std::vector<NodeAndPatch> points;
  std::vector<Eigen::RowVector3i> triangles;
  for (Eigen::Index f = 0; f < body.faces.rows(); ++f) {
    if (wanted[static_cast<std::size_t>(f)] == 0) continue;
    const int patch = body.face_patch(f);
    for (const auto& corners : mesh::face_triangles(body.order())) {
      Eigen::RowVector3i row;
      for (int k = 0; k < 3; ++k) {
        const int node = body.faces(f, corners[static_cast<std::size_t>(k)]);
        const NodeAndPatch key(node, per == PointsPer::node ? -1 : patch);
        const auto [known, is_new] = number.try_emplace(key, static_cast<int>(points.size()));
        if (is_new) points.emplace_back(node, patch);
        row(k) = known->second;
        int& own = points[static_cast<std::size_t>(row(k))].second;
        const auto count_of = [&](int p) { return size[static_cast<std::size_t>(p)]; };
        if (count_of(patch) < count_of(own)) own = patch;
      }
      triangles.push_back(row);
    }
  }
  put(body, points, triangles, surface);
}

void add_areas_and_normals(Surface& surface) {
  auto& sites = surface.sites;
  sites.area = Eigen::VectorXd::Zero(sites.count());
  sites.normal = Points::Zero(sites.count(), 3);
  for (const auto t : surface.triangles.rowwise()) {
    const Eigen::RowVector3d a = sites.position.row(t(0));
    const Eigen::RowVector3d u = sites.position.row(t(1)) - a;
    const Eigen::RowVector3d v = sites.position.row(t(2)) - a;
    const Eigen::RowVector3d twice = u.cross(v);
    for (int k = 0; k < 3; ++k) {
      sites.normal.row(t(k)) += twice;
      sites.area(t(k)) += twice.norm() / 6.0;
    }
  }
  sites.normal.rowwise().normalize();
}

void resize(Sites& sites, Eigen::Index count, Eigen::Index modes) {
  sites.shapes.resize(count, modes);
  sites.slopes.resize(count, modes);
  sites.whole.assign(static_cast<std::size_t>(count), 1);
}

// Two orthogonal directions along the surface.
std::pair<Eigen::Vector3d, Eigen::Vector3d> tangents(const Eigen::Vector3d& normal) {
  Eigen::Index axis = 0;
  normal.cwiseAbs().minCoeff(&axis);
  const Eigen::Vector3d first = normal.cross(Eigen::Vector3d::Unit(axis)).normalized();
  return {first, normal.cross(first)};
}

Eigen::Vector3d on_circle(const std::pair<Eigen::Vector3d, Eigen::Vector3d>& along, double radius,
                          int k, int count) {
  const double angle = 2.0 * std::numbers::pi * k / count;
  return radius * (std::cos(angle) * along.first + std::sin(angle) * along.second);
}

std::vector<Eigen::Index> wanted_rows(const mesh::TetMesh& body, const std::vector<char>& faces) {
  require_marks(body, faces);
  std::vector<Eigen::Index> rows;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (faces[f] != 0) rows.push_back(static_cast<Eigen::Index>(f));
  }
  require(!rows.empty(), "placement: there is no face that devices may be on");
  return rows;
}

// A mesh of these faces alone, without cells.
mesh::TetMesh faces_alone(const mesh::TetMesh& body, const std::vector<Eigen::Index>& rows) {
  mesh::TetMesh part;
  part.points = body.points;
  part.tets.resize(0, body.tets.cols());
  part.faces = body.faces(rows, Eigen::all);
  return part;
}

}  // namespace

FaceFinder::FaceFinder(const mesh::TetMesh& body, const std::vector<char>& faces)
    : rows_(wanted_rows(body, faces)), part_(faces_alone(body, rows_)), finder_(part_) {
  const auto box = mesh::bounding_box(body.points);
  slack_ = kOnLine * (box.row(1) - box.row(0)).norm();
}

mesh::Site FaceFinder::in_body(mesh::Site site) const {
  site.face = rows_[static_cast<std::size_t>(site.face)];
  return site;
}

mesh::Site FaceFinder::nearest(const Eigen::Vector3d& point) const {
  return in_body(finder_.nearest(point));
}

std::optional<mesh::Site> FaceFinder::on_line(double x, double y) const {
  if (auto site = finder_.from_above(x, y)) return in_body(std::move(*site));
  // Faces that look down or stand upright.
  auto site = finder_.beside(x, y);
  if (site.distance > slack_) return std::nullopt;
  return in_body(std::move(site));
}

Sites part(const Sites& sites, const std::vector<Eigen::Index>& rows) {
  Sites chosen;
  chosen.position = sites.position(rows, Eigen::all);
  chosen.normal = sites.normal(rows, Eigen::all);
  chosen.patch = sites.patch(rows);
  chosen.area = sites.area(rows);
  chosen.shapes = sites.shapes(rows, Eigen::all);
  chosen.slopes = sites.slopes(rows, Eigen::all);
  for (const auto row : rows) chosen.whole.push_back(sites.whole[static_cast<std::size_t>(row)]);
  return chosen;
}

Sampler::Sampler(const mesh::TetMesh& body, const modal::Modes& modes, Device device)
    : body_(body), modes_(modes), device_(std::move(device)), finder_(body) {
  require(modes.shapes.rows() == 3 * body.node_count(),
          "placement: the modes have " + fmt::to_string(modes.shapes.rows()) +
              " rows, expected 3 per node of the mesh: " + fmt::to_string(3 * body.node_count()));
  require(!device_.direction || std::abs(device_.direction->norm() - 1.0) < 1e-9,
          "placement: the direction is no unit vector");
  require(device_.footprint >= 0.0, "placement: the footprint is negative");
  const auto box = mesh::bounding_box(body.points);
  step_ = Constants::slope_step * (box.row(1) - box.row(0)).norm();
}

Eigen::RowVectorXd Sampler::value(const mesh::Site& site, const Eigen::Vector3d& direction) const {
  Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(modes_.mode_count());
  for (Eigen::Index a = 0; a < site.nodes.size(); ++a) {
    if (site.weights(a) == 0.0) continue;
    const Eigen::Index row = 3 * static_cast<Eigen::Index>(site.nodes(a));
    for (int k = 0; k < 3; ++k) {
      if (direction(k) != 0.0) sum += site.weights(a) * direction(k) * modes_.shapes.row(row + k);
    }
  }
  return sum;
}

// Whether a point on the rim of a disc lies on the body. A curved surface falls below the plane of
// the disc and turns: by r²/2R where it turns by r/R. Beyond an edge the surface lies aside.
bool is_on(const mesh::Site& nearest, const Eigen::Vector3d& rim, const Eigen::Vector3d& normal,
           double radius) {
  constexpr double kOfTurn = 0.6;  // a little more than a half
  const Eigen::Vector3d gap = rim - nearest.position;
  const double along = normal.dot(gap);
  const double turn = normal.cross(nearest.normal).norm();
  return (gap - along * normal).norm() <= Constants::rim_off * radius &&
         std::abs(along) <= (Constants::rim_off + kOfTurn * turn) * radius;
}

// The mean over a disc by Radon's rule of degree 5: the centre and six points at sqrt(2/3) of the
// radius (Abramowitz and Stegun 25.4.61).
void Sampler::see(const Eigen::Vector3d& position, const Eigen::Vector3d& normal, Eigen::Index row,
                  Sites& sites) const {
  throw_if_interrupted();
  const Eigen::Vector3d direction = device_.direction.value_or(normal);
  const auto along = tangents(normal);
  Eigen::RowVectorXd shape = value(finder_.nearest(position), direction);
  if (const double radius = 0.5 * device_.footprint; radius > 0.0) {
    shape *= 0.25;
    for (int k = 0; k < 6; ++k) {
      const Eigen::Vector3d offset = on_circle(along, std::sqrt(2.0 / 3.0) * radius, k, 6);
      shape += 0.125 * value(finder_.nearest(position + offset), direction);
    }
    for (int k = 0; k < 12; ++k) {
      const Eigen::Vector3d rim = position + on_circle(along, radius, k, 12);
      if (!is_on(finder_.nearest(rim), rim, normal, radius)) {
        sites.whole[static_cast<std::size_t>(row)] = 0;
      }
    }
  }
  Eigen::RowVectorXd squared = Eigen::RowVectorXd::Zero(shape.size());
  for (const Eigen::Vector3d& tangent : {along.first, along.second}) {
    const auto ahead = finder_.nearest(position + step_ * tangent);
    const auto behind = finder_.nearest(position - step_ * tangent);
    const double apart = (ahead.position - behind.position).norm();
    if (apart < 0.1 * step_) continue;
    squared += ((value(ahead, direction) - value(behind, direction)) / apart).cwiseAbs2();
  }
  sites.shapes.row(row) = shape;
  sites.slopes.row(row) = squared.cwiseSqrt();
}

Surface Sampler::surface(const std::vector<std::string>& patches) const {
  Surface surface;
  surface.faces = mesh::faces_of_patches(body_, patches, "placement");
  lay_out(body_, surface.faces, PointsPer::node_and_patch, surface);
  return sampled(std::move(surface));
}

Surface Sampler::smooth_surface(const std::vector<char>& faces) const {
  require_marks(body_, faces);
  Surface surface;
  surface.faces = faces;
  lay_out(body_, faces, PointsPer::node, surface);
  return sampled(std::move(surface));
}

Surface Sampler::sampled(Surface surface) const {
  add_areas_and_normals(surface);
  auto& sites = surface.sites;
  resize(sites, sites.count(), modes_.mode_count());
  parallel_ranges(static_cast<std::size_t>(sites.count()), [&](std::size_t begin, std::size_t end) {
    for (auto i = static_cast<Eigen::Index>(begin); i < static_cast<Eigen::Index>(end); ++i) {
      see(sites.position.row(i), sites.normal.row(i), i, sites);
    }
  });
  return surface;
}

Sites Sampler::at(const std::vector<mesh::Site>& places) const {
  Sites sites;
  const auto count = static_cast<Eigen::Index>(places.size());
  sites.position.resize(count, 3);
  sites.normal.resize(count, 3);
  sites.patch.resize(count);
  sites.area = Eigen::VectorXd::Ones(count);
  resize(sites, count, modes_.mode_count());
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto& place = places[static_cast<std::size_t>(i)];
    sites.position.row(i) = place.position;
    sites.normal.row(i) = place.normal;
    sites.patch(i) = body_.face_patch(place.face);
    see(place.position, place.normal, i, sites);
  }
  return sites;
}

}  // namespace chladni::placement
