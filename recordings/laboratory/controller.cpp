#include "recordings/laboratory/controller.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <complex>
#include <string>

#include "base/error.h"
#include "base/turn.h"

namespace chladni::recordings {
namespace {

struct OneAxis {
  Eigen::Matrix4d a;
  Eigen::Vector4d b;
  Eigen::RowVector4d c;
  double d = 0.0;
};

std::complex<double> polynomial(const Eigen::VectorXd& descending, std::complex<double> s) {
  std::complex<double> value = 0.0;
  for (const double coefficient : descending) value = value * s + coefficient;
  return value;
}

// Time in units of 1/bandwidth: C(s) = k (s + 0.1)(3 s + 1) / (s (s/3 + 1)(s²/64 + 1.4 s/8 + 1)).
// With |C(j)| = 1 the loop with 1/s² crosses 1 at the bandwidth.
OneAxis axis_law(double step) {
  const double lag = 1.4 / 8.0;
  Eigen::VectorXd below(5);  // s⁴ ... 1
  below << 1.0 / 192.0, 1.0 / 64.0 + lag / 3.0, lag + 1.0 / 3.0, 1.0, 0.0;
  Eigen::VectorXd above(3);
  above << 3.0, 1.3, 0.1;
  const std::complex<double> at(0.0, 1.0);
  above *= std::abs(polynomial(below, at)) / std::abs(polynomial(above, at));
  Eigen::Matrix4d a = Eigen::Matrix4d::Zero();
  a.topRightCorner<3, 3>().setIdentity();
  for (int i = 0; i < 4; ++i) a(3, i) = -below(4 - i) / below(0);
  const Eigen::Vector4d b(0.0, 0.0, 0.0, 1.0 / below(0));
  const Eigen::RowVector4d c(above(2), above(1), above(0), 0.0);
  const Eigen::Matrix4d inverse = (Eigen::Matrix4d::Identity() - 0.5 * step * a).inverse();
  return {inverse * (Eigen::Matrix4d::Identity() + 0.5 * step * a), step * inverse * b, c * inverse,
          0.5 * step * (c * inverse * b)(0)};
}

Eigen::MatrixXd pseudoinverse(const Eigen::MatrixXd& matrix, const std::string& what) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(matrix, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const auto& values = svd.singularValues();
  require(values.size() > 0 && values(values.size() - 1) > 1e-6 * values(0),
          "controller: the " + what + " do not see every axis on its own");
  return svd.matrixV() * values.cwiseInverse().asDiagonal() * svd.matrixU().transpose();
}

}  // namespace

modal::ReducedModel in_view(const modal::ReducedModel& model) {
  modal::check(model);
  const auto r = model.rigid_count;
  if (r == 0 || model.damper_count() > 0) return model;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(Eigen::MatrixXd(model.output_shapes.leftCols(r)),
                                              Eigen::ComputeFullV);
  const auto& values = svd.singularValues();
  const double largest = model.output_shapes.cwiseAbs().maxCoeff();
  Eigen::Index seen = 0;
  while (seen < values.size() && values(seen) > 1e-6 * largest) ++seen;
  const Eigen::MatrixXd turn = svd.matrixV().leftCols(seen);
  const auto flexible = model.mode_count() - r;
  modal::ReducedModel result = model;
  result.rigid_count = seen;
  result.frequency_hz.resize(seen + flexible);
  result.frequency_hz << Eigen::VectorXd::Zero(seen), model.frequency_hz.tail(flexible);
  result.damping_ratio.resize(seen + flexible);
  result.damping_ratio << Eigen::VectorXd::Zero(seen), model.damping_ratio.tail(flexible);
  result.output_shapes.resize(model.output_count(), seen + flexible);
  result.output_shapes << model.output_shapes.leftCols(r) * turn,
      model.output_shapes.rightCols(flexible);
  result.input_shapes.resize(seen + flexible, model.input_count());
  result.input_shapes << turn.transpose() * model.input_shapes.topRows(r),
      model.input_shapes.bottomRows(flexible);
  result.dampers.shapes.resize(0, seen + flexible);
  return result;
}

Controller stabiliser(const modal::ReducedModel& model, Eigen::Index axes,
                      const std::vector<Eigen::Index>& controlled, double bandwidth_hz,
                      double sample_time_s) {
  const auto inputs = static_cast<Eigen::Index>(controlled.size());
  require(axes >= 1 && axes <= model.mode_count() && inputs >= axes && model.output_count() >= axes,
          "controller: " + fmt::to_string(axes) + " axes with " + fmt::to_string(inputs) +
              " controlled actuators and " + fmt::to_string(model.output_count()) +
              " sensors; expected as many or more of both");
  require(bandwidth_hz > 0.0 && bandwidth_hz * sample_time_s <= 0.1,
          "controller: a bandwidth of " + fmt::format("{:.6g}", bandwidth_hz) +
              " Hz; expected above 0 and at most a tenth of the sampling frequency, " +
              fmt::format("{:.6g}", 0.1 / sample_time_s) + " Hz");
  for (const auto j : controlled) {
    require(j >= 0 && j < model.input_count(), "controller: no such actuator");
  }
  const Eigen::MatrixXd sense = pseudoinverse(model.output_shapes.leftCols(axes), "sensors");
  const Eigen::MatrixXd push =
      pseudoinverse(model.input_shapes(Eigen::seqN(0, axes), controlled), "controlled actuators");
  const double omega = kTwoPi * bandwidth_hz;
  const auto law = axis_law(omega * sample_time_s);
  Controller result{.a = Eigen::MatrixXd::Zero(4 * axes, 4 * axes),
                    .b = Eigen::MatrixXd(4 * axes, model.output_count()),
                    .c = Eigen::MatrixXd(inputs, 4 * axes),
                    .d = -omega * omega * law.d * push * sense,
                    .controlled = controlled};
  for (Eigen::Index i = 0; i < axes; ++i) {
    result.a.block<4, 4>(4 * i, 4 * i) = law.a;
    result.b.middleRows<4>(4 * i) = law.b * sense.row(i);
    result.c.middleCols<4>(4 * i) = -omega * omega * push.col(i) * law.c;
  }
  return result;
}

double largest_eigenvalue(const Plant& plant, const Controller& controller, double sample_time_s,
                          double delay_s) {
  const auto delay = sampled_delay(delay_s, sample_time_s);
  require(delay.whole >= 1, "controller: a loop needs a delay of one sample or more");
  const auto blocks = sampled(plant, sample_time_s, delay.fraction);
  Eigen::Index states = 0;
  for (const auto& block : blocks) states += block.a.rows();
  const auto q = static_cast<Eigen::Index>(controller.controlled.size());
  const auto own = controller.a.rows();
  const auto line = states + own;  // first u: of the last whole + 2 samples, newest first
  const auto n = line + q * (delay.whole + 2);
  const auto acting = line + q * (delay.whole - 1);  // u[k − whole] at sample k
  const auto& controlled = controller.controlled;
  Eigen::MatrixXd loop = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd see = Eigen::MatrixXd::Zero(plant.output_count(), n);
  Eigen::Index at = 0;
  for (const auto& block : blocks) {
    const auto s = block.a.rows();
    loop.block(at, at, s, s) = block.a;
    loop.block(at, acting, s, q) = block.b(Eigen::all, controlled);
    loop.block(at, acting + q, s, q) = block.b_late(Eigen::all, controlled);
    see.middleCols(at, s) = block.c;
    at += s;
  }
  const Eigen::MatrixXd through = plant.d(Eigen::all, controlled);
  for (Eigen::Index i = 0; i < 3; ++i)
    see.middleCols(acting + i * q, q) = delay.weight(i) * through;
  loop.middleRows(states, own) = controller.b * see;
  loop.block(states, states, own, own) += controller.a;
  loop.middleRows(line, q) = controller.d * see;
  loop.block(line, states, q, own) += controller.c;
  loop.block(line + q, line, q * (delay.whole + 1), q * (delay.whole + 1)).setIdentity();
  return loop.eigenvalues().cwiseAbs().maxCoeff();
}

}  // namespace chladni::recordings
