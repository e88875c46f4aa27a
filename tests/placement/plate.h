// The OAT's plate with its first modes, for the tests of this room.
#pragma once

#include "fem/assemble.h"
#include "fem/modes.h"
#include "mesh/bodies.h"
#include "placement/heat_map.h"
#include "placement/sites.h"

namespace chladni::placement {

struct Plate {
  mesh::TetMesh body;
  modal::Modes modes;  // on all nodes
};

inline Plate plate(double length = 0.6, double width = 0.6, int count = 12) {
  Plate plate;
  plate.body = mesh::with_order(mesh::layered(mesh::Plate{length, width, 0.02}, 0.05, 1), 2);
  const auto system = fem::assemble(plate.body, {fem::isotropic(70e9, 0.33, 2700.0)});
  plate.modes = fem::modes(system, {.count = count, .certificate = false}).modes;
  plate.modes.shapes = fem::on_nodes(system.dofs, plate.modes.shapes);
  return plate;
}

inline const Plate& square_plate() {
  static const Plate kept = plate();
  return kept;
}

// The first `count` flexible modes, from the first that is named.
inline std::vector<Eigen::Index> flexible(Eigen::Index first, Eigen::Index count) {
  std::vector<Eigen::Index> columns;
  for (Eigen::Index i = 0; i < count; ++i) columns.push_back(6 + first - 1 + i);
  return columns;
}

// A view of `sites` for the wanted columns, noise 1 % of each mode's root mean square.
inline PairView view_of(const Plate& plate, const Surface& surface, const Sites& sites,
                        const std::vector<Eigen::Index>& wanted, double tolerance = 0.01) {
  PairView view;
  view.groups = modal::groups(plate.modes.frequency_hz(wanted), tolerance);
  view.shapes = sites.shapes(Eigen::all, wanted);
  view.slopes = sites.slopes(Eigen::all, wanted);
  view.present.resize(0, view.shapes.cols());
  view.present_slopes.resize(0, view.shapes.cols());
  view.actuators.resize(0, view.shapes.cols());
  const auto norms =
      group_norms(surface.sites.shapes(Eigen::all, wanted), surface.sites.area, view.groups);
  view.largest = norms.largest;
  view.rms = norms.rms;
  view.sensor_noise.resize(view.shapes.cols());
  for (std::size_t g = 0; g < view.groups.size(); ++g) {
    view.sensor_noise.segment(view.groups[g].first, view.groups[g].size)
        .setConstant(0.01 * norms.rms(static_cast<Eigen::Index>(g)));
  }
  view.actuator_noise = view.sensor_noise;
  view.position_error = 2e-4;
  return view;
}

}  // namespace chladni::placement
