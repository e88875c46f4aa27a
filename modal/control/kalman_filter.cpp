#include "modal/kalman_filter.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <complex>

#include "base/error.h"
#include "dense/riccati.h"

namespace chladni::modal {
namespace {

// Eigenvalues this near to the unit circle do not decay; singular values below this part of the
// largest are 0.
constexpr double kOnCircle = 1e-9;
constexpr double kNothing = 1e-10;
constexpr double kSameAsOne = 1e-6;

dense::NoisySystem noisy_system(const DisturbedModel& system) {
  const Eigen::MatrixXd moved = system.noise_inputs();
  const Eigen::MatrixXd through = system.noise_through().topRows(system.sensors);
  Eigen::MatrixXd r = through * through.transpose();
  r.diagonal() += system.sensor_rms.cwiseAbs2();
  return {system.model.space.a, system.model.space.c.topRows(system.sensors),
          moved * moved.transpose(), r, moved * through.transpose()};
}

// An eigenvalue of rigid-body motion is double, and rounding moves it by the root of its error.
std::complex<double> rounded(std::complex<double> value) {
  return std::abs(value - 1.0) < kSameAsOne ? 1.0 : value;
}

// Names of the states with the largest part in a right null vector of [A − λ; C], for each
// eigenvalue of A that does not decay.
std::vector<std::string> null_states(const Eigen::MatrixXd& a, const Eigen::MatrixXd& c,
                                     const std::vector<Signal>& states) {
  std::vector<std::string> names;
  const auto n = a.rows();
  if (n == 0) return names;
  const double size = c.size() > 0 ? c.cwiseAbs().maxCoeff() : 0.0;
  Eigen::MatrixXcd all = Eigen::MatrixXcd::Zero(n + c.rows(), n);
  if (size > 0.0) all.bottomRows(c.rows()) = (c / size).cast<std::complex<double>>();
  std::vector<std::complex<double>> done;
  for (const auto& value : Eigen::VectorXcd(a.eigenvalues())) {
    const auto own = rounded(value);
    if (std::abs(own) < 1.0 - kOnCircle || own.imag() < 0.0) continue;
    if (std::ranges::find(done, own) != done.end()) continue;
    done.push_back(own);
    all.topRows(n) = a.cast<std::complex<double>>();
    all.topRows(n).diagonal().array() -= own;
    const Eigen::JacobiSVD<Eigen::MatrixXcd> svd(all, Eigen::ComputeThinV);
    for (auto k = n; k-- > 0 && svd.singularValues()(k) <= kNothing * svd.singularValues()(0);) {
      Eigen::Index largest = 0;
      svd.matrixV().col(k).cwiseAbs().maxCoeff(&largest);
      const auto& name = states[static_cast<std::size_t>(largest)].name;
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

void require_solvable(const DisturbedModel& system) {
  const auto unseen = unseen_states(system);
  require(unseen.empty(),
          fmt::format("no sensor sees {}, which does not decay: its error would grow for ever; "
                      "expected a sensor that sees it, or a model without it",
                      fmt::join(unseen, ", ")));
  const auto undisturbed = undisturbed_states(system);
  require(undisturbed.empty(),
          fmt::format("no disturbance moves {}, which does not decay: the filter would trust its "
                      "first value for ever; expected a disturbance that reaches it",
                      fmt::join(undisturbed, ", ")));
}

Eigen::MatrixXd symmetric(const Eigen::MatrixXd& m) { return 0.5 * (m + m.transpose()); }

}  // namespace

std::vector<std::string> unseen_states(const DisturbedModel& system) {
  const auto& space = system.model.space;
  return null_states(space.a, space.c.topRows(system.sensors), system.model.states);
}

std::vector<std::string> undisturbed_states(const DisturbedModel& system) {
  return null_states(system.model.space.a.transpose(), system.noise_inputs().transpose(),
                     system.model.states);
}

KalmanFilter kalman_filter(const DisturbedModel& system) {
  require_solvable(system);
  const auto noisy = noisy_system(system);
  KalmanFilter filter{system, {}, {}, {}, {}, {}, {}, {}};
  const auto& p = filter.covariance = dense::prediction_covariance(noisy);
  filter.innovation = symmetric(noisy.c * p * noisy.c.transpose() + noisy.r);
  const Eigen::LLT<Eigen::MatrixXd> innovation(filter.innovation);
  filter.gain =
      innovation.solve(Eigen::MatrixXd((noisy.a * p * noisy.c.transpose() + noisy.s).transpose()))
          .transpose();
  const auto wanted = system.wanted_count();
  const Eigen::MatrixXd cz = system.model.space.c.bottomRows(wanted);
  const Eigen::MatrixXd through = system.noise_through();
  const Eigen::MatrixXd at_once = through.bottomRows(wanted);
  const Eigen::MatrixXd cross =
      cz * p * noisy.c.transpose() + at_once * through.topRows(system.sensors).transpose();
  filter.point_gain = innovation.solve(Eigen::MatrixXd(cross.transpose())).transpose();
  filter.prediction_covariance = symmetric(cz * p * cz.transpose() + at_once * at_once.transpose());
  filter.point_covariance =
      symmetric(filter.prediction_covariance - filter.point_gain * cross.transpose());
  filter.pole = (noisy.a - filter.gain * noisy.c).eigenvalues();
  return filter;
}

ControlModel observer_model(const KalmanFilter& filter) {
  const auto& system = filter.system;
  const auto& from = system.model;
  const auto q = system.known;
  const auto p = system.sensors;
  const auto z = system.wanted_count();
  const Eigen::MatrixXd c = from.space.c.topRows(p);
  const Eigen::MatrixXd d = from.space.d.topRows(p).leftCols(q);
  ControlModel model = from;
  auto& space = model.space;
  space.a = from.space.a - filter.gain * c;
  space.b.resize(space.a.rows(), q + p);
  space.b << from.space.b.leftCols(q) - filter.gain * d, filter.gain;
  space.c.resize(z + p, space.a.rows());
  space.c << from.space.c.bottomRows(z) - filter.point_gain * c, -c;
  space.d.resize(z + p, q + p);
  space.d << from.space.d.bottomRows(z).leftCols(q) - filter.point_gain * d, filter.point_gain, -d,
      Eigen::MatrixXd::Identity(p, p);
  model.inputs.resize(static_cast<std::size_t>(q));
  model.outputs.erase(model.outputs.begin(), model.outputs.begin() + p);
  for (Eigen::Index i = 0; i < p; ++i) {
    const auto& sensor = from.outputs[static_cast<std::size_t>(i)];
    model.inputs.push_back(sensor);
    model.outputs.push_back({sensor.name + "_innovation", sensor.unit});
  }
  model.input_delay.conservativeResize(q + p);
  model.input_delay.head(q) = from.input_delay.head(q);
  model.input_delay.tail(p).setZero();
  model.output_delay.setZero(z + p);
  return model;
}

Estimate estimate(const KalmanFilter& filter, const Eigen::MatrixXd& inputs,
                  const Eigen::MatrixXd& outputs, bool with_states) {
  const auto& system = filter.system;
  const auto& space = system.model.space;
  const auto samples = outputs.rows();
  require(
      inputs.rows() == samples && inputs.cols() == system.known && outputs.cols() == system.sensors,
      fmt::format("estimate: found {} samples of {} inputs and {} of {} sensors, expected {} "
                  "inputs and {} sensors at the same samples",
                  inputs.rows(), inputs.cols(), samples, outputs.cols(), system.known,
                  system.sensors));
  require(inputs.allFinite() && outputs.allFinite(), "estimate: a sample is not finite");
  const auto z = system.wanted_count();
  const Eigen::MatrixXd b = system.known_inputs();
  const Eigen::MatrixXd d = space.d.leftCols(system.known);
  Estimate result{Eigen::MatrixXd(samples, z), Eigen::MatrixXd(samples, system.sensors), {}};
  if (with_states) result.states.resize(samples, system.state_count());
  Eigen::VectorXd x = Eigen::VectorXd::Zero(system.state_count());
  Eigen::VectorXd u(system.known);
  for (Eigen::Index k = 0; k < samples; ++k) {
    for (Eigen::Index j = 0; j < system.known; ++j) {
      const auto then = k - static_cast<Eigen::Index>(system.model.input_delay(j));
      u(j) = then >= 0 ? inputs(then, j) : 0.0;
    }
    const Eigen::VectorXd expected = space.c * x + d * u;
    const Eigen::VectorXd e = outputs.row(k).transpose() - expected.head(system.sensors);
    result.innovation.row(k) = e.transpose();
    result.points.row(k) = (expected.tail(z) + filter.point_gain * e).transpose();
    if (with_states) result.states.row(k) = x.transpose();
    if (with_states && system.ahead.size() > 0) {
      result.states.row(k) += (system.ahead * u).transpose();
    }
    x = (space.a * x + b * u + filter.gain * e).eval();
  }
  return result;
}

}  // namespace chladni::modal
