#include "modal/disturbed_model.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "base/turn.h"
#include "dense/riccati.h"
#include "modal/control/linear_inputs.h"

namespace chladni::modal {
namespace {

// A signal made of white noise that is held between samples: ẋ = A x + b w, signal = c x + d w.
struct Shape {
  Eigen::MatrixXd a;
  Eigen::VectorXd b;
  Eigen::RowVectorXd c;
  double d = 0.0;
  double noise_rms = 0.0;  // of w
};

void require_sound(const Disturbance& one, Eigen::Index inputs, double rate_hz) {
  const std::string what = "disturbance \"" + one.name + "\": ";
  require(one.input >= 0 && one.input < inputs, what + "it acts at no input of the model");
  require(std::isfinite(one.rms) && std::isfinite(one.density) && one.rms >= 0.0 &&
              one.density >= 0.0 && (one.rms > 0.0) != (one.density > 0.0),
          what + "expected a positive rms or a positive density");
  if (one.course == DisturbanceCourse::drift) {
    require(one.rms > 0.0 && one.drift_time_s > 0.0 && std::isfinite(one.drift_time_s),
            what + "a drift needs the rms of its change and the time in which it changes so");
  }
  if (one.course != DisturbanceCourse::band) return;
  require(one.low_hz >= 0.0 && one.low_hz < one.high_hz && one.high_hz <= 0.5 * rate_hz,
          fmt::format("{}found a band from {:.6g} to {:.6g} Hz, expected two ascending frequencies "
                      "up to half of the sample rate, {:.6g} Hz",
                      what, one.low_hz, one.high_hz, 0.5 * rate_hz));
}

// ω₂ / (s + ω₂), and with a lower end times s / (s + ω₁).
Shape band_shape(const Disturbance& one) {
  const double low = kTwoPi * one.low_hz;
  const double high = kTwoPi * one.high_hz;
  Shape shape;
  if (low == 0.0) {
    shape.a = Eigen::MatrixXd::Constant(1, 1, -high);
    shape.b = Eigen::VectorXd::Constant(1, high);
    shape.c = Eigen::RowVectorXd::Ones(1);
    return shape;
  }
  shape.a.resize(2, 2);
  shape.a << -high, 0.0, low, -low;
  shape.b = Eigen::Vector2d(high, 0.0);
  shape.c = Eigen::RowVector2d(1.0, -1.0);
  return shape;
}

// The rms at the samples for noise of rms 1.
double sampled_rms(const Shape& shape, double sample_time_s) {
  const StateSpace space{shape.a, shape.b, shape.c, Eigen::MatrixXd::Zero(1, 1), 0.0};
  const auto sampled = discretised(space, sample_time_s);
  const Eigen::MatrixXd p =
      dense::stationary_covariance(sampled.a, sampled.b * sampled.b.transpose());
  return std::sqrt((shape.c * p * shape.c.transpose())(0));
}

Shape shape_of(const Disturbance& one, double sample_time_s) {
  const double flat = std::sqrt(0.5 * one.density / sample_time_s);  // rms up to half of the rate
  Shape shape;
  switch (one.course) {
    case DisturbanceCourse::white:
      shape.d = 1.0;
      shape.noise_rms = one.density > 0.0 ? flat : one.rms;
      return shape;
    case DisturbanceCourse::band:
      shape = band_shape(one);
      shape.noise_rms = one.density > 0.0 ? flat : one.rms / sampled_rms(shape, sample_time_s);
      return shape;
    case DisturbanceCourse::drift:
      shape.a = Eigen::MatrixXd::Zero(1, 1);
      shape.b = Eigen::VectorXd::Ones(1);
      shape.c = Eigen::RowVectorXd::Ones(1);
      shape.noise_rms = one.rms / std::sqrt(one.drift_time_s * sample_time_s);
      return shape;
  }
  return shape;
}

// The model with the known inputs and one input of noise for each disturbance.
ControlModel with_noise_inputs(const ControlModel& from, Eigen::Index known,
                               const std::vector<Disturbance>& disturbances,
                               const std::vector<Shape>& shapes) {
  const auto n = from.space.a.rows();
  const auto count = static_cast<Eigen::Index>(shapes.size());
  Eigen::Index extra = 0;
  for (const auto& shape : shapes) extra += shape.a.rows();
  ControlModel to = from;
  auto& space = to.space;
  space.a = Eigen::MatrixXd::Zero(n + extra, n + extra);
  space.b = Eigen::MatrixXd::Zero(n + extra, known + count);
  space.c = Eigen::MatrixXd::Zero(from.space.c.rows(), n + extra);
  space.d = Eigen::MatrixXd::Zero(from.space.c.rows(), known + count);
  space.a.topLeftCorner(n, n) = from.space.a;
  space.b.topLeftCorner(n, known) = from.space.b.leftCols(known);
  space.c.leftCols(n) = from.space.c;
  space.d.leftCols(known) = from.space.d.leftCols(known);
  to.inputs.resize(static_cast<std::size_t>(known));
  auto at = n;
  for (Eigen::Index j = 0; j < count; ++j) {
    const auto& shape = shapes[static_cast<std::size_t>(j)];
    const auto& one = disturbances[static_cast<std::size_t>(j)];
    const auto s = shape.a.rows();
    const auto b = from.space.b.col(one.input);
    const auto d = from.space.d.col(one.input);
    space.a.block(at, at, s, s) = shape.a;
    space.a.block(0, at, n, s) = b * shape.c;
    space.b.block(at, known + j, s, 1) = shape.b;
    space.b.block(0, known + j, n, 1) = b * shape.d;
    space.c.middleCols(at, s) = d * shape.c;
    space.d.col(known + j) = d * shape.d;
    const auto& unit = from.inputs[static_cast<std::size_t>(one.input)].unit;
    for (Eigen::Index k = 0; k < s; ++k) {
      to.states.push_back({fmt::format("{}_state_{}", one.name, k + 1), unit});
    }
    to.inputs.push_back({one.name + "_noise", unit});
    at += s;
  }
  to.input_delay.conservativeResize(known + count);
  to.input_delay.tail(count).setZero();
  return to;
}

// Samples the model. Past values of known inputs are known: their delays are no states.
void set_sampled(const ControlModel& continuous, Eigen::Index known, double sample_time_s,
                 InputCourse course, DisturbedModel& result) {
  const bool is_linear = course == InputCourse::linear && known > 0;
  auto sampled =
      discretised(is_linear ? under_rates(continuous, known) : continuous, sample_time_s);
  const Eigen::VectorXd late = sampled.input_delay;
  sampled.input_delay.setZero();
  result.model = with_delay_states(sampled);
  if (is_linear) {
    Eigen::VectorXd fraction =
        continuous.input_delay.head(known) / sample_time_s - late.head(known);
    for (double& part : fraction) part = part > kSameSample ? part : 0.0;
    result.ahead = take_inputs_of_rates(continuous.space.a.rows(), fraction, result.model);
  }
  result.model.input_delay = late;
}

}  // namespace

Eigen::MatrixXd DisturbedModel::noise_inputs() const {
  return model.space.b.rightCols(noise_rms.size()) * noise_rms.asDiagonal();
}

Eigen::MatrixXd DisturbedModel::noise_through() const {
  return model.space.d.rightCols(noise_rms.size()) * noise_rms.asDiagonal();
}

DisturbedModel disturbed_model(const ControlModel& continuous, Eigen::Index known,
                               const std::vector<Disturbance>& disturbances,
                               const Eigen::VectorXd& sensor_rms, double sample_time_s,
                               InputCourse course) {
  check(continuous);
  const auto inputs = continuous.space.b.cols();
  require(known >= 0 && known <= inputs && sensor_rms.size() <= continuous.space.c.rows(),
          "disturbed model: more known inputs or sensors than the model has");
  require(sensor_rms.size() > 0, "disturbed model: there is no sensor");
  require(std::isfinite(sample_time_s) && sample_time_s > 0.0,
          "disturbed model: expected a sample time above 0");
  for (Eigen::Index i = 0; i < sensor_rms.size(); ++i) {
    require(std::isfinite(sensor_rms(i)) && sensor_rms(i) > 0.0,
            fmt::format("disturbed model: the noise of sensor \"{}\" is {}; expected an rms above "
                        "0",
                        continuous.outputs[static_cast<std::size_t>(i)].name, sensor_rms(i)));
  }
  DisturbedModel result;
  std::vector<Shape> shapes;
  result.noise_rms.resize(static_cast<Eigen::Index>(disturbances.size()));
  for (std::size_t j = 0; j < disturbances.size(); ++j) {
    require_sound(disturbances[j], inputs, 1.0 / sample_time_s);
    shapes.push_back(shape_of(disturbances[j], sample_time_s));
    result.noise_rms(static_cast<Eigen::Index>(j)) = shapes.back().noise_rms;
  }
  set_sampled(with_noise_inputs(continuous, known, disturbances, shapes), known, sample_time_s,
              course, result);
  result.known = known;
  result.sensors = sensor_rms.size();
  result.sensor_rms = sensor_rms;
  return result;
}

}  // namespace chladni::modal
