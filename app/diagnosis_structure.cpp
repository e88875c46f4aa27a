#include "app/diagnosis_structure.h"

#include <algorithm>
#include <cmath>

#include "app/at_channels.h"
#include "app/modal_stiffness.h"
#include "app/plane_stress.h"
#include "app/study_parts.h"
#include "app/upper_face.h"
#include "base/error.h"
#include "base/parallel.h"
#include "fem/field_matrices.h"

namespace chladni::app {
namespace {

constexpr int kFlexibleModes = 64;
constexpr Eigen::Index kLeastFlexibleModes = 12;
constexpr double kBeyondBand = 3.0;
constexpr int kCells = 100;      // of a face
constexpr int kCellsAlong = 24;  // of a line
constexpr double kStep = 1e-4;   // of a channel's slope, over the body's shorter side
constexpr double kThin = 0.125;  // thickness over the shorter side

Eigen::Index modes_in_use(const Solution& solution, double high_hz) {
  const auto& modes = solution.modes;
  Eigen::Index count = std::min(modes.rigid_count + kLeastFlexibleModes, modes.mode_count());
  while (count < modes.mode_count() && modes.frequency_hz(count) <= kBeyondBand * high_hz) ++count;
  for (const auto& cluster : solution.summary.clusters) {
    if (cluster.first < count) count = std::max(count, cluster.first + cluster.size);
  }
  return std::min(count, modes.mode_count());
}

modal::Modes first(const modal::Modes& modes, Eigen::Index count) {
  return {modes.frequency_hz.head(count), modes.damping_ratio.head(count),
          modes.shapes.leftCols(count), modes.rigid_count};
}

// The modes that were solved for but are not in use. Beyond them a plate has as many modes per Hz
// as below, a beam fewer and fewer: Σ 1/ω² is K/ω_K² and a third of it.
ModesAbove above(const modal::Modes& modes, Eigen::Index used, bool slender) {
  const Eigen::Index count = modes.mode_count() - used;
  if (count <= 0) return {};
  const Eigen::VectorXd omega = 2.0 * std::numbers::pi * modes.frequency_hz.tail(count);
  const double flexible = static_cast<double>(modes.mode_count() - modes.rigid_count);
  const double rest = (slender ? 1.0 / 3.0 : 1.0) * flexible / std::pow(omega(count - 1), 2);
  return {modes.shapes.rightCols(count) * omega.cwiseInverse().asDiagonal(),
          rest / static_cast<double>(count) * omega.cwiseAbs2()};
}

// Rows of the shapes at sites along one direction.
Eigen::MatrixXd along(const std::vector<mesh::Site>& sites, const Eigen::Vector3d& direction,
                      const modal::Modes& modes) {
  const auto n = static_cast<Eigen::Index>(sites.size());
  return shapes_at(sites, Points(direction.transpose().replicate(n, 1)), modes);
}

// How a channel's row changes as it moves along `axis` on the body.
Eigen::VectorXd slope_at(const mesh::SiteFinder& finder, const mesh::Site& site,
                         const Eigen::Vector3d& direction, const Eigen::Vector3d& axis, double step,
                         const modal::Modes& modes) {
  return slope(
      [&](double offset) -> std::optional<Eigen::VectorXd> {
        const Eigen::Vector3d wanted = site.position + offset * axis;
        const auto there = finder.nearest(wanted);
        if ((there.position - wanted).norm() > 0.5 * step) return {};  // beyond the edge
        return along({there}, direction, modes).row(0).transpose();
      },
      step);
}

diagnosis::ChannelSide side_of(const std::vector<Channel>& channels,
                               const std::vector<mesh::Site>& sites, const mesh::SiteFinder& finder,
                               const Chart& chart, const modal::Modes& modes) {
  diagnosis::ChannelSide side;
  side.names = names_of(channels);
  side.shapes = shapes_at(channels, sites, modes);
  side.aside_u = along(sites, chart.axes.col(0), modes);
  side.aside_v = along(sites, chart.axes.col(1), modes);
  side.slope_u.resizeLike(side.shapes);
  side.slope_v.resizeLike(side.shapes);
  side.places.resize(side.shapes.rows(), 2);
  const double step = kStep * chart.size.minCoeff();
  for (Eigen::Index i = 0; i < side.shapes.rows(); ++i) {
    const auto& site = sites[static_cast<std::size_t>(i)];
    const auto& direction = channels[static_cast<std::size_t>(i)].direction;
    side.places.row(i) = chart.place(site.position);
    side.slope_u.row(i) = slope_at(finder, site, direction, chart.axes.col(0), step, modes);
    side.slope_v.row(i) = slope_at(finder, site, direction, chart.axes.col(1), step, modes);
  }
  return side;
}

// Of the channels, c×(u + 1): what is beyond the modes above yields only where it is pushed.
Eigen::MatrixXd upper_rows(const std::vector<Channel>& channels,
                           const std::vector<mesh::Site>& sites, const ModesAbove& beyond) {
  const auto c = static_cast<Eigen::Index>(channels.size());
  const Eigen::Index u = beyond.shapes.cols();
  if (u == 0) return {c, 0};
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(c, u + 1);
  rows.leftCols(u) = shapes_at(
      channels, sites, {Eigen::VectorXd::Zero(u), Eigen::VectorXd::Zero(u), beyond.shapes, 0});
  return rows;
}

// Points spread over a tetrahedron, 20×4 barycentric, of equal weight.
Eigen::Matrix<double, 20, 4> samples_of_tet() {
  Eigen::Matrix<double, 20, 4> points;
  Eigen::Index n = 0;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; i + j < 4; ++j) {
      for (int k = 0; i + j + k < 4; ++k) {
        const Eigen::Vector4d lattice(i, j, k, 3 - i - j - k);
        points.row(n++) = (lattice.array() + 0.25) / 4.0;
      }
    }
  }
  return points;
}

// The tetrahedra of a cell and how much of each is in it.
struct CellPart {
  std::vector<Eigen::Index> tets;
  std::vector<double> part;
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();  // of the samples' places
  double samples = 0.0;
};

void add_sample(CellPart& cell, Eigen::Index tet, double weight, const Eigen::Vector2d& place) {
  if (cell.tets.empty() || cell.tets.back() != tet) {
    cell.tets.push_back(tet);
    cell.part.push_back(0.0);
  }
  cell.part.back() += weight;
  cell.moment += weight * place;
  cell.samples += weight;
}

std::vector<CellPart> parts_of(const mesh::TetMesh& body, const Chart& chart,
                               const Eigen::Vector2i& counts) {
  std::vector<CellPart> cells(static_cast<std::size_t>(counts.prod()));
  const auto samples = samples_of_tet();
  const double weight = 1.0 / static_cast<double>(samples.rows());
  for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
    Eigen::Matrix<double, 4, 3> corners;
    for (int a = 0; a < 4; ++a) corners.row(a) = body.points.row(body.tets(t, a));
    for (const auto barycentric : samples.rowwise()) {
      const Eigen::Vector2d at = chart.place((barycentric * corners).transpose());
      Eigen::Vector2i cell;
      for (int k = 0; k < 2; ++k) {
        const double fraction = (at(k) - chart.from(k)) / chart.size(k);
        cell(k) = std::clamp(static_cast<int>(std::floor(fraction * counts(k))), 0, counts(k) - 1);
      }
      add_sample(cells[static_cast<std::size_t>(cell(0) * counts(1) + cell(1))], t, weight, at);
    }
  }
  return cells;
}

// Materials that resist transverse shear only: that with `normal` in it.
std::vector<fem::Material> shearing(std::vector<fem::Material> materials, Eigen::Index normal) {
  for (auto& material : materials) {
    const Eigen::Matrix<double, 6, 6> whole = material.stiffness;
    material.stiffness.setZero();
    for (Eigen::Index i = 0; i < 3; ++i) {
      const Eigen::Index s = shear_of(i, normal);
      if (i != normal) material.stiffness(s, s) = whole(s, s);
    }
  }
  return materials;
}

Eigen::MatrixXd symmetric(const Eigen::MatrixXd& matrix) {
  return 0.5 * (matrix + matrix.transpose());
}

// What the cells are made of.
class CellMatrices {
 public:
  CellMatrices(const Model& model, const modal::Modes& modes, const Chart& chart, bool bends)
      : model_(model), modes_(modes), bends_(bends) {
    if (!bends) return;
    Eigen::Index normal = 0;
    chart.axes.col(2).cwiseAbs().maxCoeff(&normal);
    shearing_ = shearing(model.materials, normal);
    turning_ = modes.shapes;
    for (Eigen::Index row = normal; row < turning_.rows(); row += 3) turning_.row(row).setZero();
  }

  void add(const CellPart& part, diagnosis::BodyCells& cells, std::size_t at) const {
    mesh::TetMesh piece;
    piece.points = model_.body.points;
    piece.tets = model_.body.tets(part.tets, Eigen::all);
    piece.region = model_.body.region(part.tets);
    const Eigen::MatrixXd field = Eigen::Map<const Eigen::VectorXd>(
        part.part.data(), static_cast<Eigen::Index>(part.part.size()));
    const Eigen::MatrixXd none(field.rows(), 0);
    auto whole = fem::field_matrices(piece, model_.materials, modes_.shapes, field, field);
    cells.stiffness[at] = unstrained(std::move(whole.stiffness.front()), modes_.frequency_hz);
    cells.mass[at] = symmetric(whole.mass.front());
    if (!bends_) return;
    auto sheared = fem::field_matrices(piece, shearing_, modes_.shapes, field, none);
    cells.shear[at] = unstrained(std::move(sheared.stiffness.front()), modes_.frequency_hz);
    cells.rotary[at] =
        symmetric(fem::field_matrices(piece, model_.materials, turning_, none, field).mass.front());
  }

 private:
  const Model& model_;
  const modal::Modes& modes_;
  bool bends_;
  std::vector<fem::Material> shearing_;
  Eigen::MatrixXd turning_;  // the shapes, in the plane only
};

diagnosis::BodyCells cells_of(const Model& model, const modal::Modes& modes, const Chart& chart,
                              const UpperFace& face, bool bends) {
  const auto counts = grid_counts(chart, kCells, kCellsAlong);
  const Eigen::MatrixXd covered = coverage(chart, face, counts);
  const double area = chart.size.prod() / static_cast<double>(counts.prod());
  const auto parts = parts_of(model.body, chart, counts);
  std::vector<std::size_t> filled;
  for (std::size_t c = 0; c < parts.size(); ++c) {
    if (!parts[c].tets.empty()) filled.push_back(c);
  }
  diagnosis::BodyCells cells;
  const auto count = static_cast<Eigen::Index>(filled.size());
  cells.centres.resize(count, 2);
  cells.area.resize(count);
  cells.from = chart.from;
  cells.size = chart.size;
  for (auto* matrices : {&cells.stiffness, &cells.mass}) matrices->resize(filled.size());
  for (auto* matrices : {&cells.shear, &cells.rotary}) matrices->resize(bends ? filled.size() : 0);
  const CellMatrices matrices(model, modes, chart, bends);
  parallel_tasks(filled.size(), [&](std::size_t i) {
    const auto number = static_cast<Eigen::Index>(filled[i]);
    const auto& part = parts[filled[i]];
    matrices.add(part, cells, i);
    cells.centres.row(static_cast<Eigen::Index>(i)) = (part.moment / part.samples).transpose();
    cells.area(static_cast<Eigen::Index>(i)) =
        covered(number / counts(1), number % counts(1)) * area;
  });
  return cells;
}

diagnosis::Directional directional_of(const Model& model, const modal::Modes& modes,
                                      const Chart& chart) {
  Eigen::Index u = 0;
  Eigen::Index v = 0;
  chart.axes.col(0).maxCoeff(&u);
  chart.axes.col(1).maxCoeff(&v);
  const auto doubled = [&](Eigen::Index row, Eigen::Index col, int constant_row, int constant_col) {
    return modal_stiffness(model, modes, [&](const fem::Material& material) {
      Eigen::Matrix<double, 6, 6> change = Eigen::Matrix<double, 6, 6>::Zero();
      change(row, col) = change(col, row) =
          plane_stress(material.stiffness, u, v)(constant_row, constant_col);
      return change;
    });
  };
  const Eigen::Index s = shear_of(u, v);
  return {doubled(u, u, 0, 0), doubled(v, v, 1, 1), doubled(u, v, 0, 1), doubled(s, s, 2, 2)};
}

}  // namespace

Study with_modes_for_diagnosis(Study study) {
  study.modes.count = std::max(study.modes.count, kFlexibleModes);
  study.modes.up_to_hz = 0.0;
  return study;
}

diagnosis::Structure structure_of(const Study& study, const Solution& solution, double high_hz) {
  require(!study.sensors.empty() && !study.actuators.empty(),
          study.file.string() + ": a diagnosis needs a sensor and an actuator or more");
  const Eigen::Index count = modes_in_use(solution, high_hz);
  const auto& model = solution.model;
  const modal::Modes modes = first(solution.modes, count);
  const auto reduced = at_channels(study, solution, count);
  const auto chart = chart_of(model.body);
  const mesh::SiteFinder finder(model.body);
  const auto beyond = above(solution.modes, count, chart.is_slender());
  const auto face = std::make_shared<const UpperFace>(chart, model.body, modes.shapes, beyond);
  diagnosis::Structure structure;
  structure.frequency_hz = reduced.frequency_hz;
  structure.damping_ratio = reduced.damping_ratio;
  structure.rigid_count = reduced.rigid_count;
  if (reduced.damper_count() > 0) {
    structure.dashpots = reduced.dampers.shapes.transpose() * reduced.dampers.shapes;
  }
  structure.outputs = side_of(study.sensors, model.sensors, finder, chart, modes);
  structure.inputs = side_of(study.actuators, model.actuators, finder, chart, modes);
  structure.outputs.upper = upper_rows(study.sensors, model.sensors, beyond);
  structure.inputs.upper = upper_rows(study.actuators, model.actuators, beyond);
  structure.residual = reduced.residual;
  structure.surface = surface_of(chart, face);
  const bool thin = chart.height < kThin * chart.size.minCoeff();
  structure.cells = cells_of(model, modes, chart, *face, thin);
  structure.thickness = chart.height;
  structure.mass_kg = model.mass.mass_kg;
  structure.bending_power = thin ? 3.0 : 0.0;
  if (thin) structure.directional = directional_of(model, modes, chart);
  check(structure);
  return structure;
}

}  // namespace chladni::app
