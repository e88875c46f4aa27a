// gain_study [tables]: the gain between four sensors and thirteen actuators, 120 mm and more from
// each other, on plates that the simulation does not know; figures in bench/README.md.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "base/draw.h"
#include "priors/gain.h"
#include "priors/learned_corrections.h"
#include "simulators/tables/plate_corrections.h"
#include "simulators/tables/plate_study.h"
#include "simulators/tables/real_tables.h"

namespace chladni {
namespace {

constexpr int kModes = 12;
constexpr Eigen::Index kFirst = 9;
constexpr double kNoise = 0.01;

// 120 mm from the nearest actuator of both layouts.
Eigen::MatrixX2d sensor_places() {
  Eigen::MatrixX2d at(4, 2);
  at << -0.25, 0.12, 0.12, 0.25, 0.25, -0.12, -0.12, -0.25;
  return at;
}

struct Errors {
  std::vector<double> nearest, uncorrected, corrected;  // |beta hat / beta - 1|
};

double relative(double log_gain, double truth) {
  return std::abs(std::exp(log_gain - truth) - 1.0);
}

// "Assume collocated" (thesis 6.2.1): the nearest actuator of each sensor, by (5.5).
double nearest_gain(const priors::TwoSidedShape& shape) {
  double ll = 0.0;
  double rr = 0.0;
  for (Eigen::Index s = 0; s < shape.sensors.count(); ++s) {
    Eigen::Index k = 0;
    (shape.actuators.position.rowwise() - shape.sensors.position.row(s))
        .rowwise()
        .norm()
        .minCoeff(&k);
    ll += shape.sensor_values(s) * shape.sensor_values(s);
    rr += shape.actuator_values(k) * shape.actuator_values(k);
  }
  return 0.5 * std::log(ll / rr);  // L over R is alpha squared, beta
}

void add_table(unsigned seed, const std::string& layout, const simulators::KirchhoffPlate& plate,
               const simulators::PlateModes& believed, Errors& errors) {
  const auto table = simulators::plate_modes(simulators::real_table(seed), kModes);
  const auto surface = simulators::plate_surface(table);
  const auto actuators = simulators::layout(layout);
  const auto test =
      simulators::plate_test(table, believed, surface, actuators, kModes, kNoise, 100 + seed);
  const auto simulation = simulators::plate_simulation(believed, surface);
  const auto basis = priors::modal_basis(simulation);
  const auto plain = priors::learned_errors(test.measured, basis);
  const auto learned = priors::learned_corrections(test.measured, basis,
                                                   simulators::plate_corrections(plate, believed));
  const auto corrected = priors::corrected_basis(basis, learned.likeliest.modes);
  const Eigen::VectorXd rms = simulators::unit_rms(
      simulators::shapes_at(table, surface.places).rightCols(kModes), surface.area);
  const Eigen::MatrixXd at_sensors =
      simulators::shapes_at(table, sensor_places()).rightCols(kModes) * rms.asDiagonal();
  Draw draw(500 + seed);
  for (Eigen::Index i = 0; i < kFirst; ++i) {
    const double truth = 1.0 + draw.uniform();
    const double alpha = std::exp(0.5 * truth);
    priors::TwoSidedShape shape;
    shape.frequency_hz = test.measured.frequency_hz(i);
    shape.sensors = simulators::plate_places(believed, sensor_places());
    shape.actuators = test.measured.places;
    shape.actuator_values = test.measured.values.col(i) / alpha;
    shape.actuator_noise = test.measured.noise.col(i) / alpha;
    shape.sensor_values = at_sensors.col(i);
    for (double& value : shape.sensor_values) value += kNoise * draw.normal();
    shape.sensor_values *= alpha;
    shape.sensor_noise = Eigen::VectorXd::Constant(4, alpha * kNoise);
    errors.nearest.push_back(relative(nearest_gain(shape), truth));
    errors.uncorrected.push_back(
        relative(priors::gain_match(shape, basis, plain.errors.prior).log_gain, truth));
    const auto& turn = learned.likeliest.modes.turn;
    shape.sensors.shapes = (shape.sensors.shapes * turn).eval();
    shape.actuators.shapes = (shape.actuators.shapes * turn).eval();
    errors.corrected.push_back(relative(
        priors::gain_match(shape, corrected, learned.likeliest.errors.prior).log_gain, truth));
  }
}

void print(const char* name, std::vector<double> errors) {
  std::sort(errors.begin(), errors.end());
  const auto at = [&](double part) {
    return errors[static_cast<std::size_t>(part * static_cast<double>(errors.size() - 1))];
  };
  fmt::print("{:44} {:6.1f} % {:6.1f} %\n", name, 100.0 * at(0.5), 100.0 * at(0.9));
}

}  // namespace
}  // namespace chladni

int main(int argc, char** argv) {
  using namespace chladni;
  const unsigned count = argc > 1 ? static_cast<unsigned>(std::atoi(argv[1])) : 20;
  const auto plate = simulators::minimal_table(25);
  const auto believed = simulators::plate_modes(plate, 40);
  for (const auto* layout : {"quincunx", "rings"}) {
    Errors errors;
    for (unsigned seed = 1; seed <= count; ++seed) {
      add_table(seed, layout, plate, believed, errors);
    }
    fmt::print("{}: error of beta, median and 90 %\n", layout);
    print("nearest taken for collocated (thesis)", errors.nearest);
    print("evidence, simulation as it is", errors.uncorrected);
    print("evidence, simulation corrected", errors.corrected);
  }
}
