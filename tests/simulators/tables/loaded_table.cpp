#include "simulators/tables/loaded_table.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <complex>
#include <numbers>

#include "base/error.h"
#include "simulators/portable_random.h"
#include "simulators/tables/table_channels.h"

namespace chladni::simulators {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Complex = std::complex<double>;

// The plate with its mass and spring: squares of the angular frequencies, and shapes in terms of
// the bare plate's modes.
struct Loaded {
  VectorXd lambda;
  MatrixXd shapes;
};

Loaded loaded(const RitzModes& plate, const LoadedTable& table) {
  const VectorXd omega = 2.0 * std::numbers::pi * plate.frequency_hz;
  MatrixXd stiffness = omega.cwiseAbs2().asDiagonal();
  MatrixXd mass = MatrixXd::Identity(omega.size(), omega.size());
  const auto row = [&](const Eigen::Vector2d& place) {
    return VectorXd(modal_rows(plate, place.transpose()).deflection.row(0).transpose());
  };
  const VectorXd there = row(table.place);
  const VectorXd foot = row(table.foot);
  mass += table.mass * there * there.transpose();
  stiffness += table.spring * foot * foot.transpose();
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(stiffness, mass);
  require(modes.info() == Eigen::Success, "a mass below that of the plate is expected");
  return {modes.eigenvalues().cwiseMax(0.0), modes.eigenvectors()};
}

double median_size(const std::vector<MatrixXcd>& responses) {
  std::vector<double> all;
  for (const auto& g : responses) {
    for (const auto& entry : g.reshaped()) all.push_back(std::abs(entry));
  }
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  return *middle;
}

}  // namespace

modal::FrfSet loaded_table(const RitzModes& plate, const LoadedTable& table) {
  const auto channel = table_channels();
  const auto [lambda, shapes] = loaded(plate, table);
  const MatrixXd outputs = modal_rows(plate, channel.outputs).deflection * shapes;
  const MatrixXd inputs = modal_rows(plate, channel.inputs).deflection * shapes;
  modal::FrfSet set;
  set.outputs = measured_channels(channel.output_names, channel.outputs, "m");
  set.inputs = measured_channels(channel.input_names, channel.inputs, "N");
  set.frequency_hz = VectorXd::LinSpaced(table.lines, table.low_hz, table.high_hz);
  VectorXd ratio = VectorXd::Constant(lambda.size(), table.damping_ratio);
  if (table.damping_spread > 0.0) {
    Dice spread(table.seed + 1000);
    for (double& one : ratio) one *= std::exp(table.damping_spread * spread.normal());
  }
  for (const double hz : set.frequency_hz) {
    const double omega = 2.0 * std::numbers::pi * hz;
    Eigen::VectorXcd modal(lambda.size());
    modal.real() = lambda.array() - omega * omega;
    modal.imag() = 2.0 * omega * ratio.cwiseProduct(lambda.cwiseSqrt());
    set.value.emplace_back(outputs.cast<Complex>() * modal.cwiseInverse().asDiagonal() *
                           inputs.transpose().cast<Complex>());
  }
  const double floor = 0.1 * table.noise * median_size(set.value);
  Dice dice(table.seed);
  for (auto& g : set.value) {
    const MatrixXd variance =
        (table.noise * table.noise * g.cwiseAbs2().array() + floor * floor).matrix();
    const MatrixXd deviation = (0.5 * variance).cwiseSqrt();
    MatrixXcd noise(g.rows(), g.cols());
    noise.real() = deviation.cwiseProduct(dice.normal(g.rows(), g.cols()));
    noise.imag() = deviation.cwiseProduct(dice.normal(g.rows(), g.cols()));
    g += noise;
    set.variance.push_back(variance);
  }
  return set;
}

}  // namespace chladni::simulators
