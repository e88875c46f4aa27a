#include "simulators/tables/plate_study.h"

#include <cmath>
#include <numbers>

#include "base/error.h"
#include "simulators/portable_random.h"

namespace chladni::simulators {

namespace {

constexpr int kHalfWaves = 10;  // 0 to 9 along each side

Eigen::VectorXd harmonic_eigenvalues(const PlateGrid& grid) {
  Eigen::VectorXd mu(kHalfWaves * kHalfWaves);
  for (int j = 0; j < mu.size(); ++j) {
    const int along = j % kHalfWaves;
    const int across = j / kHalfWaves;
    mu(j) = std::pow(std::numbers::pi * along / grid.length, 2) +
            std::pow(std::numbers::pi * across / grid.width, 2);
  }
  return mu;
}

Eigen::MatrixXd harmonics_at(const PlateGrid& grid, const Eigen::MatrixX2d& places) {
  const Eigen::ArrayXd x = std::numbers::pi * (places.col(0).array() / grid.length + 0.5);
  const Eigen::ArrayXd y = std::numbers::pi * (places.col(1).array() / grid.width + 0.5);
  Eigen::MatrixXd values(places.rows(), kHalfWaves * kHalfWaves);
  for (int j = 0; j < values.cols(); ++j) {
    const int along = j % kHalfWaves;
    const int across = j / kHalfWaves;
    values.col(j) = (x * along).cos() * (y * across).cos();
  }
  return values;
}

}  // namespace

priors::Places plate_places(const PlateModes& modes, const Eigen::MatrixX2d& places) {
  priors::Places seen;
  seen.position = Points::Zero(places.rows(), 3);
  seen.position.leftCols<2>() = places;
  seen.direction = Points::Zero(places.rows(), 3);
  seen.direction.col(2).setOnes();
  seen.shapes = shapes_at(modes, places);
  seen.harmonics = harmonics_at(modes.grid, places);
  return seen;
}

priors::Simulation plate_simulation(const PlateModes& believed, const PlateSurface& surface) {
  priors::Simulation simulation;
  simulation.frequency_hz = believed.frequency_hz;
  simulation.surface = plate_places(believed, surface.places);
  simulation.area = surface.area;
  simulation.harmonic_eigenvalue = harmonic_eigenvalues(believed.grid);
  return simulation;
}

Eigen::VectorXd unit_rms(const Eigen::MatrixXd& shapes, const Eigen::VectorXd& area) {
  const Eigen::VectorXd square = shapes.array().square().matrix().transpose() * area / area.sum();
  return square.cwiseSqrt().cwiseInverse();
}

PlateTest plate_test(const PlateModes& truth, const PlateModes& believed,
                     const PlateSurface& surface, const Eigen::MatrixX2d& places, int count,
                     double noise, unsigned seed) {
  require(truth.mode_count() >= 3 + count, "plate: the truth has too few modes");
  const Eigen::MatrixXd shapes = shapes_at(truth, surface.places).middleCols(3, count);
  const Eigen::VectorXd scale = unit_rms(shapes, surface.area);
  PlateTest test;
  test.truth = shapes * scale.asDiagonal();
  test.measured.places = plate_places(believed, places);
  test.measured.frequency_hz = truth.frequency_hz.segment(3, count);
  test.measured.noise = Eigen::MatrixXd::Constant(places.rows(), count, noise);
  test.measured.values = shapes_at(truth, places).middleCols(3, count) * scale.asDiagonal() +
                         noise * Dice(seed).normal(places.rows(), count);
  return test;
}

}  // namespace chladni::simulators
