#include "simulators/frf_cases.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>

#include "base/error.h"
#include "simulators/plates/kirchhoff_plate.h"
#include "simulators/portable_random.h"

namespace chladni::simulators {

namespace {

using std::numbers::pi;

Eigen::VectorXd or_ones(const Eigen::VectorXd& gain, Eigen::Index size) {
  return gain.size() == 0 ? Eigen::VectorXd::Ones(size) : gain;
}

// The response: (s² + s D + Ω²)⁻¹ between the shapes, where D includes the dampers.
Eigen::MatrixXcd response(const modal::ReducedModel& model, double frequency_hz) {
  const std::complex<double> s(0.0, 2.0 * pi * frequency_hz);
  const Eigen::ArrayXd omega = 2.0 * pi * model.frequency_hz.array();
  const Eigen::ArrayXd rate = 2.0 * model.damping_ratio.array() * omega;
  const Eigen::VectorXcd diagonal =
      (s * s + s * rate.cast<std::complex<double>>() + omega.square()).matrix();
  if (model.damper_count() == 0) {
    return model.output_shapes * diagonal.cwiseInverse().asDiagonal() * model.input_shapes;
  }
  Eigen::MatrixXcd dynamic = s * (model.dampers.shapes.transpose() * model.dampers.shapes);
  dynamic.diagonal() += diagonal;
  return model.output_shapes *
         dynamic.partialPivLu().solve(model.input_shapes.cast<std::complex<double>>());
}

void append_mode(modal::ReducedModel& model, double frequency_hz, double damping) {
  Dice dice(97);
  const auto m = model.mode_count();
  const auto extended = [&](const Eigen::VectorXd& values, double last) {
    Eigen::VectorXd longer(m + 1);
    longer << values, last;
    return longer;
  };
  const double outputs = model.output_shapes.col(m - 1).norm();
  const double inputs = model.input_shapes.row(m - 1).norm();
  model.frequency_hz = extended(model.frequency_hz, frequency_hz);
  model.damping_ratio = extended(model.damping_ratio, damping);
  model.output_shapes.conservativeResize(Eigen::NoChange, m + 1);
  model.output_shapes.col(m) = outputs * dice.normal(model.output_count(), 1).normalized();
  model.input_shapes.conservativeResize(m + 1, Eigen::NoChange);
  model.input_shapes.row(m) = inputs * dice.normal(1, model.input_count()).normalized();
  if (model.damper_count() > 0) model.dampers.shapes.conservativeResize(Eigen::NoChange, m + 1);
}

void append_dashpot(modal::ReducedModel& model, double constant) {
  const auto d = model.damper_count();
  model.dampers.shapes.conservativeResize(d + 1, model.mode_count());
  model.dampers.shapes.row(d) = std::sqrt(constant) * model.output_shapes.row(0);
  model.dampers.to_outputs = Eigen::MatrixXd::Zero(model.output_count(), d + 1);
  model.dampers.from_inputs = Eigen::MatrixXd::Zero(d + 1, model.input_count());
  model.dampers.among = Eigen::MatrixXd::Zero(d + 1, d + 1);
}

std::vector<modal::MeasuredChannel> channels(const Eigen::MatrixX3d& places, char letter,
                                             const std::string& unit) {
  std::vector<modal::MeasuredChannel> list(static_cast<std::size_t>(places.rows()));
  for (std::size_t i = 0; i < list.size(); ++i) {
    list[i].name = letter + std::to_string(i + 1);
    list[i].direction = Eigen::Vector3d::UnitZ();
    list[i].position = places.row(static_cast<Eigen::Index>(i)).transpose();
    list[i].unit = unit;
  }
  return list;
}

double median_magnitude(const std::vector<Eigen::MatrixXcd>& value) {
  const auto per_line = static_cast<std::size_t>(value.front().size());
  const std::size_t step = 1 + value.size() * per_line / 4000000;  // a million is enough
  std::vector<double> magnitude;
  for (std::size_t k = 0; k < value.size(); k += step) {
    for (const auto& g : value[k].reshaped()) magnitude.push_back(std::abs(g));
  }
  const auto middle = magnitude.begin() + static_cast<std::ptrdiff_t>(magnitude.size() / 2);
  std::nth_element(magnitude.begin(), middle, magnitude.end());
  return *middle;
}

// Adds noise relative to the responses without gains, so that a dead channel still has noise.
void add_noise(FrfCase& made, const std::vector<Eigen::MatrixXcd>& ungained) {
  const auto& faults = made.faults;
  const double floor =
      faults.floor_noise > 0.0 ? faults.floor_noise * median_magnitude(ungained) : 0.0;
  Dice dice(faults.seed);
  made.measured.value = made.exact;
  made.measured.variance.resize(made.exact.size());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t k = 0; k < made.exact.size(); ++k) {
    auto& variance = made.measured.variance[k];
    variance = (faults.relative_noise * ungained[k].cwiseAbs()).cwiseAbs2();
    variance.array() += floor * floor;
    for (Eigen::Index e = 0; e < variance.size(); ++e) {
      const double real = dice.normal();
      const double imag = dice.normal();
      auto& value = made.measured.value[k](e);
      if (faults.noisy) value += std::sqrt(0.5 * variance(e)) * std::complex<double>(real, imag);
      if (faults.missing > 0.0 && dice.uniform() < faults.missing) value = {nan, nan};
    }
  }
}

std::vector<std::pair<Eigen::Index, Eigen::Index>> collocated_of(const FrfGrid& grid) {
  std::vector<std::pair<Eigen::Index, Eigen::Index>> list;
  for (Eigen::Index i = 0; i < grid.outputs.rows(); ++i) {
    for (Eigen::Index j = 0; j < grid.inputs.rows(); ++j) {
      if ((grid.outputs.row(i) - grid.inputs.row(j)).norm() < 1e-9) list.emplace_back(i, j);
    }
  }
  return list;
}

Eigen::MatrixX3d along_x(const Eigen::VectorXd& x) {
  Eigen::MatrixX3d places = Eigen::MatrixX3d::Zero(x.size(), 3);
  places.col(0) = x;
  return places;
}

// The nth shape of a free beam of unit length and mass at x in [−1/2, 1/2].
double free_beam_shape(int n, double x) {
  constexpr double kWaveNumbers[] = {4.730040744862704, 7.853204624095838, 10.995607838001671};
  const double beta = kWaveNumbers[n];
  const double at = beta * (x + 0.5);
  const double ratio = (std::cosh(beta) - std::cos(beta)) / (std::sinh(beta) - std::sin(beta));
  return std::cosh(at) + std::cos(at) - ratio * (std::sinh(at) + std::sin(at));
}

Eigen::MatrixXd beam_shapes(const Eigen::VectorXd& x) {
  constexpr double kLength = 0.5;
  constexpr double kMass = 0.157;
  Eigen::MatrixXd shapes(x.size(), 5);
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double along = x(i) / kLength;
    shapes.row(i) << 1.0, std::sqrt(12.0) * along, free_beam_shape(0, along),
        free_beam_shape(1, along), free_beam_shape(2, along);
  }
  return shapes / std::sqrt(kMass);
}

FrfCase beam(const Eigen::VectorXd& actuators, const FrfFaults& faults) {
  const Eigen::VectorXd sensors = Eigen::VectorXd::LinSpaced(5, -0.2, 0.2);
  modal::ReducedModel model;
  model.frequency_hz = Eigen::VectorXd{{2.5, 5.0, 32.7, 51.9, 110.0}};
  model.damping_ratio = Eigen::VectorXd{{0.02, 0.02, 0.008, 0.005, 0.01}};
  model.output_shapes = beam_shapes(sensors);
  model.input_shapes = beam_shapes(actuators).transpose();
  return frf_case(
      model, {along_x(sensors), along_x(actuators), Eigen::VectorXd::LinSpaced(799, 0.5, 200.0)},
      faults);
}

// A free aluminium plate whose thickness puts the first flexible mode at 139 Hz.
PlateModes plate_of_139_hz(double width, int flexible) {
  constexpr double kThickness = 0.0149;
  const double modulus = 70e9;
  const double poisson = 0.33;
  const double bending = modulus * std::pow(kThickness, 3) / (12.0 * (1.0 - poisson * poisson));
  auto modes = plate_modes(
      uniform_plate({0.6, width, 20, 20}, isotropic_bending(bending, poisson), 2700.0 * kThickness),
      flexible);
  modes.frequency_hz *= 139.0 / modes.frequency_hz(3);
  return modes;
}

Eigen::MatrixX3d in_plane(const Eigen::MatrixX2d& places) {
  Eigen::MatrixX3d lifted = Eigen::MatrixX3d::Zero(places.rows(), 3);
  lifted.leftCols<2>() = places;
  return lifted;
}

// The model with the rigid-body modes and `flexible` modes that both sides see.
modal::ReducedModel plate_model(const PlateModes& modes, const Eigen::MatrixX2d& outputs,
                                const Eigen::MatrixX2d& inputs, Eigen::Index flexible) {
  const Eigen::MatrixXd seen = shapes_at(modes, outputs);
  const Eigen::MatrixXd driven = shapes_at(modes, inputs);
  std::vector<Eigen::Index> kept = {0, 1, 2};
  for (Eigen::Index m = 3; m < modes.mode_count() && std::ssize(kept) < flexible + 3; ++m) {
    const bool visible = seen.col(m).norm() > 0.1 * seen.col(0).norm() &&
                         driven.col(m).norm() > 0.1 * driven.col(0).norm();
    if (visible) kept.push_back(m);
  }
  require(std::ssize(kept) == flexible + 3, "plate_model: the plate was asked for too few modes");
  modal::ReducedModel model;
  model.rigid_count = 3;
  model.frequency_hz = modes.frequency_hz(kept);
  model.damping_ratio = Eigen::VectorXd::Zero(flexible + 3);
  for (Eigen::Index m = 3; m < flexible + 3; ++m) {
    model.damping_ratio(m) = 0.003 + 0.001 * static_cast<double>((5 * m) % 8);
  }
  model.output_shapes = seen(Eigen::all, kept);
  model.input_shapes = driven(Eigen::all, kept).transpose();
  return model;
}

Eigen::MatrixX2d random_places(Eigen::Index count, Dice& dice) {
  Eigen::MatrixX2d places(count, 2);
  for (double& x : places.reshaped()) x = dice.between(-0.29, 0.29);
  return places;
}

}  // namespace

FrfCase frf_case(const modal::ReducedModel& truth, const FrfGrid& grid, const FrfFaults& faults) {
  FrfCase made;
  made.faults = faults;
  made.truth = truth;
  made.truth.residual = Eigen::MatrixXd::Zero(truth.output_count(), truth.input_count());
  if (faults.out_of_band > 0.0) {
    append_mode(made.truth, (1.0 + faults.out_of_band) * grid.frequency_hz.maxCoeff(), 0.005);
  }
  if (faults.dashpot > 0.0) append_dashpot(made.truth, faults.dashpot);
  made.collocated = collocated_of(grid);
  made.measured.outputs = channels(grid.outputs, 'y', "m");
  made.measured.inputs = channels(grid.inputs, 'u', "N");
  made.measured.frequency_hz = grid.frequency_hz;
  const Eigen::VectorXd rows = or_ones(faults.output_gain, truth.output_count());
  const Eigen::VectorXd columns = or_ones(faults.input_gain, truth.input_count());
  const Eigen::VectorXd delay =
      Eigen::VectorXd::Constant(rows.size(), faults.delay_s) +
      (faults.output_delay_s.size() == 0 ? Eigen::VectorXd::Zero(rows.size())
                                         : faults.output_delay_s);
  std::vector<Eigen::MatrixXcd> ungained;
  for (const double frequency : grid.frequency_hz) {
    const Eigen::ArrayXd phase = -2.0 * pi * frequency * delay.array();
    Eigen::ArrayXcd turn(phase.size());
    turn.real() = phase.cos();
    turn.imag() = phase.sin();
    ungained.push_back(turn.matrix().asDiagonal() * response(made.truth, frequency));
    made.exact.push_back(rows.asDiagonal() * ungained.back() * columns.asDiagonal());
  }
  add_noise(made, ungained);
  return made;
}

FrfCase beam5x3(const FrfFaults& faults) { return beam(Eigen::Vector3d(-0.2, 0.0, 0.2), faults); }

FrfCase beam5x5(const FrfFaults& faults) {
  return beam(Eigen::VectorXd::LinSpaced(5, -0.2, 0.2), faults);
}

FrfCase oat4x13(const FrfFaults& faults) {
  Eigen::MatrixX2d sensors(4, 2);
  sensors << -0.25, 0.25, 0.25, 0.25, 0.25, -0.25, -0.25, -0.25;
  Eigen::MatrixX2d actuators(13, 2);
  actuators << -0.18, 0.18, 0.18, 0.18, 0.18, -0.18, -0.18, -0.18, 0.0, 0.0, -0.12, 0.0, 0.12, 0.0,
      0.0, 0.12, 0.0, -0.12, -0.24, 0.0, 0.24, 0.0, 0.0, 0.24, 0.0, -0.24;
  const auto model = plate_model(plate_of_139_hz(0.5988, 24), sensors, actuators, 17);
  return frf_case(
      model,
      {in_plane(sensors), in_plane(actuators), Eigen::VectorXd::LinSpaced(3981, 10.0, 2398.0)},
      faults);
}

FrfCase pairs(double split, double first, double second, const FrfFaults& faults) {
  Dice dice(11);
  modal::ReducedModel model;
  model.frequency_hz = Eigen::Vector4d(50.0, 100.0, 100.0 * (1.0 + split), 180.0);
  model.damping_ratio = Eigen::Vector4d(0.01, first, second, 0.01);
  model.output_shapes = dice.normal(4, 4);
  model.input_shapes = model.output_shapes.topRows(3).transpose();
  const Eigen::VectorXd places = Eigen::VectorXd::LinSpaced(4, 0.0, 0.3);
  return frf_case(
      model,
      {along_x(places), along_x(places.head(3)), Eigen::VectorXd::LinSpaced(921, 20.0, 250.0)},
      faults);
}

FrfCase big(Eigen::Index outputs, Eigen::Index inputs, Eigen::Index modes, Eigen::Index lines,
            const FrfFaults& faults) {
  Dice dice(5);
  const auto sensors = random_places(outputs, dice);
  const auto actuators = random_places(inputs, dice);
  const auto plate = plate_of_139_hz(0.5988, static_cast<int>(modes - 3));
  const auto model = plate_model(plate, sensors, actuators, modes - 3);
  const double last = 1.2 * model.frequency_hz(modes - 1);
  return frf_case(model,
                  {in_plane(sensors), in_plane(actuators),
                   Eigen::VectorXd::LinSpaced(lines, last / static_cast<double>(lines), last)},
                  faults);
}

FrfCase part(const FrfCase& whole, const std::vector<Eigen::Index>& outputs,
             const std::vector<Eigen::Index>& inputs) {
  FrfCase chosen = whole;
  chosen.truth.output_shapes = whole.truth.output_shapes(outputs, Eigen::all);
  chosen.truth.input_shapes = whole.truth.input_shapes(Eigen::all, inputs);
  chosen.truth.residual = whole.truth.residual(outputs, inputs);
  if (whole.truth.damper_count() > 0) {
    chosen.truth.dampers.to_outputs = whole.truth.dampers.to_outputs(outputs, Eigen::all);
    chosen.truth.dampers.from_inputs = whole.truth.dampers.from_inputs(Eigen::all, inputs);
  }
  const auto picked = [](const auto& list, const std::vector<Eigen::Index>& which) {
    std::remove_cvref_t<decltype(list)> some;
    for (const auto i : which) some.push_back(list[static_cast<std::size_t>(i)]);
    return some;
  };
  chosen.measured.outputs = picked(whole.measured.outputs, outputs);
  chosen.measured.inputs = picked(whole.measured.inputs, inputs);
  for (std::size_t k = 0; k < whole.exact.size(); ++k) {
    chosen.exact[k] = whole.exact[k](outputs, inputs);
    chosen.measured.value[k] = whole.measured.value[k](outputs, inputs);
    chosen.measured.variance[k] = whole.measured.variance[k](outputs, inputs);
  }
  const auto some_of = [](const Eigen::VectorXd& values, const std::vector<Eigen::Index>& which) {
    return values.size() == 0 ? values : Eigen::VectorXd(values(which));
  };
  chosen.faults.output_gain = some_of(whole.faults.output_gain, outputs);
  chosen.faults.input_gain = some_of(whole.faults.input_gain, inputs);
  chosen.faults.output_delay_s = some_of(whole.faults.output_delay_s, outputs);
  chosen.collocated.clear();
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (std::size_t j = 0; j < inputs.size(); ++j) {
      const std::pair here(outputs[i], inputs[j]);
      if (std::ranges::find(whole.collocated, here) != whole.collocated.end()) {
        chosen.collocated.emplace_back(i, j);
      }
    }
  }
  return chosen;
}

ComplexModes complex_modes(const modal::ReducedModel& truth) {
  const auto r = truth.rigid_count;
  const auto n = truth.mode_count() - r;
  const Eigen::VectorXd omega = 2.0 * pi * truth.frequency_hz.tail(n);
  Eigen::MatrixXd rate =
      (2.0 * truth.damping_ratio.tail(n).cwiseProduct(omega)).asDiagonal().toDenseMatrix();
  if (truth.damper_count() > 0) {
    const Eigen::MatrixXd damper = truth.dampers.shapes.rightCols(n);
    require(truth.dampers.shapes.leftCols(r).norm() <= 1e-12 * damper.norm(),
            "complex_modes: a damper reaches a rigid-body mode");
    rate += damper.transpose() * damper;
  }
  Eigen::MatrixXd first_order = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  first_order.topRightCorner(n, n) = omega.asDiagonal();  // of (Ω q, dq/dt): balanced
  first_order.bottomLeftCorner(n, n) = (-omega).asDiagonal();
  first_order.bottomRightCorner(n, n) = -rate;
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(first_order);
  std::vector<Eigen::Index> upper;
  for (Eigen::Index i = 0; i < 2 * n; ++i) {
    if (solver.eigenvalues()(i).imag() > 0.0) upper.push_back(i);
  }
  std::ranges::sort(upper, {}, [&](Eigen::Index i) { return std::abs(solver.eigenvalues()(i)); });
  ComplexModes modes;
  modes.pole = solver.eigenvalues()(upper);
  // The quadratic pencil is symmetric, so left and right vectors are equal, with vᵀ(2p + D)v = 1.
  Eigen::MatrixXcd shapes =
      omega.cwiseInverse().asDiagonal() * solver.eigenvectors().topRows(n)(Eigen::all, upper);
  for (Eigen::Index i = 0; i < std::ssize(upper); ++i) {
    const Eigen::VectorXcd v = shapes.col(i);
    const std::complex<double> scale =
        (v.transpose() * (2.0 * modes.pole(i) * v + rate * v)).value();
    shapes.col(i) /= std::sqrt(scale);
  }
  modes.outputs = truth.output_shapes.rightCols(n) * shapes;
  modes.inputs = shapes.transpose() * truth.input_shapes.bottomRows(n);
  return modes;
}

}  // namespace chladni::simulators
