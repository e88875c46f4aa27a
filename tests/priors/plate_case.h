// A real table seen by a model that does not know it, for the tests of this room.
#pragma once

#include <Eigen/Eigenvalues>
#include <numbers>

#include "base/draw.h"
#include "simulators/tables/plate_study.h"
#include "simulators/tables/real_tables.h"

namespace chladni::priors {

struct PlateCase {
  Simulation simulation;
  MeasuredShapes measured;
  Eigen::MatrixXd truth;  // on the surface
};

inline const simulators::PlateModes& minimal_modes() {
  static const auto kept = simulators::plate_modes(simulators::minimal_table(20), 20);
  return kept;
}

inline const simulators::PlateModes& table_modes(unsigned seed) {
  static std::vector<simulators::PlateModes> kept(simulators::kRealTables + 1);
  if (kept[seed].mode_count() == 0) {
    kept[seed] = simulators::plate_modes(simulators::real_table(seed), 12);
  }
  return kept[seed];
}

// Models that differ from the minimal one by masses of up to 5 % of its own, anywhere.
inline std::vector<SimilarModel> similar_models(const Simulation& simulation) {
  Draw draw(3);
  std::vector<SimilarModel> models;
  const auto r = simulation.mode_count();
  const Eigen::VectorXd omega = 2.0 * std::numbers::pi * simulation.frequency_hz;
  for (int k = 0; k < 20; ++k) {
    Eigen::MatrixXd mass = Eigen::MatrixXd::Identity(r, r);
    for (int i = 0; i < 4; ++i) {
      const double kg = 1.0 * draw.uniform();
      const auto at = static_cast<Eigen::Index>(draw.uniform() *
                                                static_cast<double>(simulation.surface.count()));
      const Eigen::RowVectorXd shape = simulation.surface.shapes.row(at);
      mass += kg * shape.transpose() * shape;
    }
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(
        omega.cwiseAbs2().asDiagonal().toDenseMatrix(), mass);
    models.push_back({solver.eigenvalues().cwiseMax(0.0).cwiseSqrt() / (2.0 * std::numbers::pi),
                      solver.eigenvectors()});
  }
  return models;
}

inline PlateCase plate_case(const Eigen::MatrixX2d& places, unsigned table = 1, int modes = 12,
                            double noise = 0.01) {
  const auto surface = simulators::plate_surface(table_modes(table));
  auto test = simulators::plate_test(table_modes(table), minimal_modes(), surface, places, modes,
                                     noise, 100 + table);
  PlateCase made{simulators::plate_simulation(minimal_modes(), surface), std::move(test.measured),
                 std::move(test.truth)};
  made.simulation.similar = similar_models(made.simulation);
  return made;
}

inline PlateCase plate_case(const std::string& layout = "rings", unsigned table = 1, int modes = 12,
                            double noise = 0.01) {
  return plate_case(simulators::layout(layout), table, modes, noise);
}

}  // namespace chladni::priors
