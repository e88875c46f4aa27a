#include "stage/reduction/upper_face.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "mesh/surface.h"
#include "stage/estimates/waves.h"

namespace chladni::stage {
namespace {

constexpr int kScan = 350;           // places on a face
constexpr int kScanAlong = 100;      // along a line
constexpr int kSamples = 4;          // per side of a rectangle, to measure its covered part
constexpr double kSlopeStep = 1e-3;  // step for a slope, over the mean size of the mesh's faces
constexpr double kLeastPart = 0.5 / (kSamples * kSamples);  // covered, if no sample hits the body

// The boundary alone, in the chart's coordinates, with new node numbers; `kept` has the old ones.
mesh::TetMesh shell_of(const Chart& chart, const mesh::TetMesh& body,
                       std::vector<Eigen::Index>& kept) {
  mesh::TetMesh shell;
  shell.tets.resize(0, body.tets.cols());
  shell.faces = body.faces;
  std::vector<int> number(static_cast<std::size_t>(body.node_count()), -1);
  for (auto& node : shell.faces.reshaped()) {
    auto& own = number[static_cast<std::size_t>(node)];
    if (own < 0) {
      own = static_cast<int>(kept.size());
      kept.push_back(node);
    }
    node = own;
  }
  shell.points = (body.points(kept, Eigen::all).rowwise() - chart.origin.transpose()) * chart.axes;
  return shell;
}

double step_of_slopes(const mesh::TetMesh& shell) {
  double area = 0.0;
  for (const auto face : shell.faces.rowwise()) {
    const Eigen::Vector3d a = shell.points.row(face(0));
    const Eigen::Vector3d b = shell.points.row(face(1));
    const Eigen::Vector3d c = shell.points.row(face(2));
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  return kSlopeStep * std::sqrt(area / static_cast<double>(shell.faces.rows()));
}

Eigen::VectorXd value_at(const mesh::Site& site, const UpperFace::Motions& motion) {
  Eigen::VectorXd value = Eigen::VectorXd::Zero(motion.cols());
  for (Eigen::Index a = 0; a < site.nodes.size(); ++a) {
    value += site.weights(a) * motion.row(site.nodes(a)).transpose();
  }
  return value;
}

// The rectangle's centre if it is on the body. Else, of its samples on the body, the one nearest to
// their mean.
std::optional<Eigen::Vector2d> middle(const Chart& chart, const UpperFace& face,
                                      const Eigen::Vector2i& counts, int i, int j) {
  const Eigen::Vector2d centre = grid_place(chart, counts, i, j);
  if (face.holds(centre)) return centre;
  std::vector<Eigen::Vector2d> on;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (int k = 0; k < kSamples * kSamples; ++k) {
    const auto at = grid_place(chart, kSamples * counts, kSamples * i + k / kSamples,
                               kSamples * j + k % kSamples);
    if (!face.holds(at)) continue;
    on.push_back(at);
    sum += at;
  }
  if (on.empty()) return {};
  const Eigen::Vector2d mean = sum / static_cast<double>(on.size());
  return *std::min_element(on.begin(), on.end(), [&](const auto& a, const auto& b) {
    return (a - mean).norm() < (b - mean).norm();
  });
}

}  // namespace

Chart chart_of(const mesh::TetMesh& body) {
  const auto [first, second] = longest_sides(body);
  return chart_along(body, Eigen::Vector3d::Unit(3 - first - second));
}

Chart chart_along(const mesh::TetMesh& body, const Eigen::Vector3d& normal) {
  Eigen::Index n = 0;
  normal.cwiseAbs().maxCoeff(&n);
  Eigen::Vector3d u = Eigen::Vector3d::Unit((n + 1) % 3);
  if (normal.dot(u) != 0.0) u = (u - normal.dot(u) * normal).normalized();
  Chart chart;
  chart.axes << u, normal.cross(u), normal;
  const auto box = mesh::bounding_box(body.points * chart.axes);
  chart.origin = box(1, 2) * normal;
  chart.from = box.row(0).head<2>().transpose();
  const Eigen::Vector3d size = (box.row(1) - box.row(0)).transpose();
  chart.size = size.head<2>();
  chart.height = size(2);
  return chart;
}

Eigen::Vector2d grid_place(const Chart& chart, const Eigen::Vector2i& counts, int i, int j) {
  const Eigen::Vector2d fraction((i + 0.5) / counts(0), (j + 0.5) / counts(1));
  return chart.from + fraction.cwiseProduct(chart.size);
}

Eigen::Vector2i grid_counts(const Chart& chart, double total, int along) {
  Eigen::Vector2i counts = Eigen::Vector2i::Ones();
  if (chart.is_slender()) {
    counts(chart.size(0) < chart.size(1) ? 1 : 0) = along;
    return counts;
  }
  const double pitch = std::sqrt(chart.size.prod() / total);
  for (int k = 0; k < 2; ++k) {
    counts(k) = std::max(1, static_cast<int>(std::lround(chart.size(k) / pitch)));
  }
  return counts;
}

Eigen::VectorXd slope(const std::function<std::optional<Eigen::VectorXd>(double offset)>& value,
                      double step) {
  const auto above = value(step);
  const auto below = value(-step);
  if (above && below) return (*above - *below) / (2.0 * step);
  const auto here = value(0.0);
  if (above && here) return (*above - *here) / step;
  if (below && here) return (*here - *below) / step;
  return here ? Eigen::VectorXd::Zero(here->size()) : Eigen::VectorXd();
}

UpperFace::UpperFace(const Chart& chart, const mesh::TetMesh& body, const Eigen::MatrixXd& shapes,
                     const ModesAbove& above, std::vector<char> chosen)
    : shell_(shell_of(chart, body, nodes_)),
      chosen_(std::move(chosen)),
      finder_(shell_),
      beyond_(above.beyond),
      step_(step_of_slopes(shell_)) {
  Eigen::Index k = 0;
  for (auto& motion : motions_) {
    const Eigen::RowVector3d axis = chart.axes.col(k++).transpose();
    motion.resize(shell_.node_count(), shapes.cols() + above.shapes.cols());
    for (Eigen::Index i = 0; i < motion.rows(); ++i) {
      const Eigen::Index first = 3 * nodes_[static_cast<std::size_t>(i)];
      motion.row(i).head(shapes.cols()) = axis * shapes.middleRows<3>(first);
      if (above.shapes.cols() == 0) continue;
      motion.row(i).tail(above.shapes.cols()) = axis * above.shapes.middleRows<3>(first);
    }
  }
}

std::optional<mesh::Site> UpperFace::uppermost(const Eigen::Vector2d& place) const {
  auto site = finder_.from_above(place(0), place(1));
  const bool counts =
      site && (chosen_.empty() || chosen_[static_cast<std::size_t>(site->face)] != 0);
  return counts ? std::move(site) : std::nullopt;
}

bool UpperFace::holds(const Eigen::Vector2d& place) const { return uppermost(place).has_value(); }

std::optional<double> UpperFace::height(const Eigen::Vector2d& place) const {
  const auto here = uppermost(place);
  if (!here) return {};
  return here->position(2);
}

std::optional<diagnosis::PointMotion> UpperFace::at(const Eigen::Vector2d& place) const {
  const auto here = uppermost(place);
  if (!here) return {};
  const Eigen::VectorXd value = value_at(*here, motions_[2]);
  const auto along = [&](const Eigen::Vector2d& axis) {
    return slope(
        [&](double offset) -> std::optional<Eigen::VectorXd> {
          if (offset == 0.0) return value;
          const Eigen::Vector2d there = place + offset * axis;
          const auto site = finder_.from_above(there(0), there(1));
          // Beyond a step in the body's height is another place.
          const bool near = site && std::abs(site->position(2) - here->position(2)) < 2.0 * step_;
          if (!near) return {};
          return value_at(*site, motions_[2]);
        },
        step_);
  };
  const Eigen::VectorXd u = along(Eigen::Vector2d::UnitX());
  const Eigen::VectorXd v = along(Eigen::Vector2d::UnitY());
  const Eigen::Index above = beyond_.size();
  const Eigen::Index r = value.size() - above;
  Eigen::MatrixXd aside(value.size(), 2);
  aside << value_at(*here, motions_[0]), value_at(*here, motions_[1]);
  diagnosis::PointMotion motion{value.head(r), u.head(r), v.head(r), {}, {}, {}};
  motion.aside = aside.topRows(r);
  if (above == 0) return motion;
  const Eigen::VectorXd weighted = beyond_.cwiseProduct(value.tail(above));
  const double rest = std::sqrt(weighted.dot(value.tail(above)));
  const auto with_rest = [&](const Eigen::VectorXd& all, double last) {
    Eigen::VectorXd result(above + 1);
    result << all.tail(above), last;
    return result;
  };
  const double per = rest > 0.0 ? 1.0 / rest : 0.0;
  motion.upper = with_rest(value, rest);
  motion.upper_slope_u = with_rest(u, per * weighted.dot(u.tail(above)));
  motion.upper_slope_v = with_rest(v, per * weighted.dot(v.tail(above)));
  motion.upper_aside.resize(above + 1, 2);
  motion.upper_aside << aside.bottomRows(above),
      per * weighted.transpose() * aside.bottomRows(above);
  return motion;
}

Eigen::MatrixXd coverage(const Chart& chart, const UpperFace& face, const Eigen::Vector2i& counts) {
  Eigen::MatrixXd part = Eigen::MatrixXd::Zero(counts(0), counts(1));
  const Eigen::Vector2i fine = kSamples * counts;
  for (int i = 0; i < fine(0); ++i) {
    for (int j = 0; j < fine(1); ++j) {
      if (!face.holds(grid_place(chart, fine, i, j))) continue;
      part(i / kSamples, j / kSamples) += 1.0 / (kSamples * kSamples);
    }
  }
  return part;
}

diagnosis::Surface surface_of(const Chart& chart, std::shared_ptr<const UpperFace> face) {
  // A body with large openings is scanned as densely as others.
  const double covered = coverage(chart, *face, grid_counts(chart, kScan, kScanAlong)).mean();
  require(covered > 0.0,
          "diagnosis: none of the faces that it looks at is uppermost; "
          "[diagnosis] on names others");
  const Eigen::Vector2i counts =
      grid_counts(chart, kScan / covered, static_cast<int>(std::lround(kScanAlong / covered)));
  const Eigen::MatrixXd part = coverage(chart, *face, counts);
  const double whole = chart.size.prod() / counts.prod();
  std::vector<diagnosis::PointMotion> motions;
  std::vector<Eigen::Vector3d> places;  // u, v, area
  for (int i = 0; i < counts(0); ++i) {
    for (int j = 0; j < counts(1); ++j) {
      const auto at = middle(chart, *face, counts, i, j);
      if (!at) continue;
      motions.push_back(face->at(*at).value());
      places.emplace_back((*at)(0), (*at)(1), std::max(part(i, j), kLeastPart) * whole);
    }
  }
  diagnosis::Surface surface;
  const auto n = static_cast<Eigen::Index>(places.size());
  surface.places.resize(n, 2);
  surface.area.resize(n);
  surface.shapes.resize(n, motions.front().shape.size());
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto& place = places[static_cast<std::size_t>(k)];
    surface.places.row(k) = place.head<2>();
    surface.area(k) = place(2);
    surface.shapes.row(k) = motions[static_cast<std::size_t>(k)].shape;
  }
  surface.origin = chart.origin;
  surface.axis_u = chart.axes.col(0);
  surface.axis_v = chart.axes.col(1);
  surface.directions = 3;
  surface.at = [face](const Eigen::Vector2d& place) { return face->at(place); };
  surface.has_place = [face](const Eigen::Vector2d& place) { return face->holds(place); };
  return surface;
}

}  // namespace chladni::stage
