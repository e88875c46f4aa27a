#include "stage/diagnosis_structure.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "fem/field_matrices.h"
#include "stage/at_channels.h"
#include "stage/diagnosis_faces.h"
#include "stage/plane_stress.h"
#include "stage/reduction/body_cells.h"
#include "stage/reduction/grown_body.h"
#include "stage/reduction/modal_stiffness.h"
#include "stage/reduction/upper_face.h"

namespace chladni::stage {
namespace {

constexpr Eigen::Index kLeastFlexibleModes = 12;
constexpr double kBeyondBand = 3.0;
constexpr double kStep = 1e-4;  // step for a channel's slope, over the body's shorter side
constexpr double kAside = 0.2;  // sine of the angle to the normal beyond which no channel is tilted
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

// The modes that were solved for but are not in use. Beyond them a plate has a constant number of
// modes per Hz, and a beam fewer and fewer: Σ 1/ω² is K/ω_K², or a third of it for a beam.
ModesAbove above(const modal::Modes& modes, Eigen::Index used, bool slender) {
  const Eigen::Index count = modes.mode_count() - used;
  if (count <= 0) return {};
  const Eigen::VectorXd omega = 2.0 * std::numbers::pi * modes.frequency_hz.tail(count);
  const double flexible = static_cast<double>(modes.mode_count() - modes.rigid_count);
  const double rest = (slender ? 1.0 / 3.0 : 1.0) * flexible / std::pow(omega(count - 1), 2);
  return {modes.shapes.rightCols(count) * omega.cwiseInverse().asDiagonal(),
          rest / static_cast<double>(count) * omega.cwiseAbs2()};
}

// Rows of the shapes at sites in one direction.
Eigen::MatrixXd along(const std::vector<mesh::Site>& sites, const Eigen::Vector3d& direction,
                      const modal::Modes& modes) {
  const auto n = static_cast<Eigen::Index>(sites.size());
  return shapes_at(sites, Points(direction.transpose().replicate(n, 1)), modes);
}

// Change of a channel's row as it moves along `axis` on the body.
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

diagnosis::ChannelSide side_of(const std::vector<study::Channel>& channels,
                               const std::vector<mesh::Site>& sites, const mesh::SiteFinder& finder,
                               const Chart& chart, const modal::Modes& modes) {
  diagnosis::ChannelSide side;
  side.names = study::names_of(channels);
  side.shapes = shapes_at(channels, sites, modes);
  side.aside_u = along(sites, chart.axes.col(0), modes);
  side.aside_v = along(sites, chart.axes.col(1), modes);
  side.slope_u.resizeLike(side.shapes);
  side.slope_v.resizeLike(side.shapes);
  side.places.resize(side.shapes.rows(), 2);
  side.directions.resize(side.shapes.rows(), 3);
  const double step = kStep * chart.size.minCoeff();
  for (Eigen::Index i = 0; i < side.shapes.rows(); ++i) {
    const auto& site = sites[static_cast<std::size_t>(i)];
    const auto& direction = channels[static_cast<std::size_t>(i)].direction;
    side.places.row(i) = chart.place(site.position);
    side.directions.row(i) = direction.transpose() * chart.axes;
    side.slope_u.row(i) = slope_at(finder, site, direction, chart.axes.col(0), step, modes);
    side.slope_v.row(i) = slope_at(finder, site, direction, chart.axes.col(1), step, modes);
    if ((chart.axes.leftCols<2>().transpose() * direction).norm() > kAside) {
      for (auto* aside : {&side.aside_u, &side.aside_v}) aside->row(i).setZero();
    }
  }
  return side;
}

// Rows of the channels, c×(u + 1). The last column is 0: the part beyond the modes above yields
// only at the place of a force.
Eigen::MatrixXd upper_rows(const std::vector<study::Channel>& channels,
                           const std::vector<mesh::Site>& sites, const ModesAbove& beyond) {
  const auto c = static_cast<Eigen::Index>(channels.size());
  const Eigen::Index u = beyond.shapes.cols();
  if (u == 0) return {c, 0};
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(c, u + 1);
  rows.leftCols(u) = shapes_at(
      channels, sites, {Eigen::VectorXd::Zero(u), Eigen::VectorXd::Zero(u), beyond.shapes, 0});
  return rows;
}

diagnosis::Directional directional_of(const Model& model, const modal::Modes& modes,
                                      const Chart& chart) {
  const Eigen::Matrix3d body_axes = chart.axes.transpose();  // in the chart's frame
  const auto doubled = [&](Eigen::Index row, Eigen::Index col, int constant_row, int constant_col) {
    return modal_stiffness(model, modes, [&](const fem::Material& material) {
      const auto own = fem::turned(material, body_axes);
      fem::Material change{Eigen::Matrix<double, 6, 6>::Zero(), material.density};
      change.stiffness(row, col) = change.stiffness(col, row) =
          plane_stress(own.stiffness, 0, 1)(constant_row, constant_col);
      return fem::turned(change, chart.axes).stiffness;
    });
  };
  const Eigen::Index s = shear_of(0, 1);
  return {doubled(0, 0, 0, 0), doubled(1, 1, 1, 1), doubled(0, 1, 0, 1), doubled(s, s, 2, 2)};
}

// Adds the attachments: stiffness and mass of the modes minus those of the body.
void add_attached(const Model& model, const modal::Modes& modes, diagnosis::Structure& structure) {
  if (model.attachments.empty()) return;
  const Eigen::MatrixXd everywhere = Eigen::MatrixXd::Ones(model.body.tet_count(), 1);
  auto body =
      fem::field_matrices(model.body, model.materials, modes.shapes, everywhere, everywhere);
  const Eigen::VectorXd omega = 2.0 * std::numbers::pi * modes.frequency_hz;
  structure.springs = -unstrained(std::move(body.stiffness.front()), modes.frequency_hz);
  structure.springs.diagonal() += omega.cwiseAbs2();
  structure.masses = -0.5 * (body.mass.front() + body.mass.front().transpose());
  structure.masses.diagonal().array() += 1.0;
}

}  // namespace

study::Study with_modes_for_diagnosis(study::Study study) {
  study.modes.count = std::max(study.modes.count, kDiagnosisModes);
  study.modes.up_to_hz = 0.0;
  return study;
}

diagnosis::Structure structure_of(const study::Study& study, const Solution& solution,
                                  double high_hz) {
  const Eigen::Index count = modes_in_use(solution, high_hz);
  const auto& model = solution.model;
  const modal::Modes modes = first(solution.modes, count);
  const auto reduced = at_channels(study, solution, count);
  const auto faces = diagnosed_faces(study, model.body);
  const auto& chart = faces.chart;
  const mesh::SiteFinder finder(model.body);
  const auto beyond = above(solution.modes, count, chart.is_slender());
  const auto face =
      std::make_shared<const UpperFace>(chart, model.body, modes.shapes, beyond, faces.chosen);
  diagnosis::Structure structure;
  structure.frequency_hz = reduced.frequency_hz;
  structure.damping_ratio = reduced.damping_ratio;
  structure.rigid_count = reduced.rigid_count;
  if (solution.frequency_error.size() > 0) {
    structure.frequency_error = solution.frequency_error.head(count).cwiseAbs();
  }
  if (reduced.damper_count() > 0) {
    structure.dashpots = reduced.dampers.shapes.transpose() * reduced.dampers.shapes;
  }
  add_attached(model, modes, structure);
  structure.outputs = side_of(study.sensors, model.sensors, finder, chart, modes);
  structure.inputs = side_of(study.actuators, model.actuators, finder, chart, modes);
  structure.outputs.upper = upper_rows(study.sensors, model.sensors, beyond);
  structure.inputs.upper = upper_rows(study.actuators, model.actuators, beyond);
  structure.residual = reduced.residual;
  structure.surface = surface_of(chart, face);
  const bool thin = chart.height < kThin * chart.size.minCoeff();
  structure.cells = cells_of(model, modes, chart, *face, thin);
  structure.fine = fine_cells_of(model, solution.modes, count, chart);
  structure.thickness = chart.height;
  structure.mass_kg = model.mass.mass_kg;
  structure.bending_power = thin ? 3.0 : 0.0;
  if (thin) {  // bodies of which size_error and orthotropy may be said
    structure.grown = beneath_attached(solution, count, chart);
    structure.directional = directional_of(model, modes, chart);
  }
  check(structure);
  return structure;
}

}  // namespace chladni::stage
