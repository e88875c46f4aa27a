#include "identification/gains/imaginary_rows.h"

#include <Eigen/Core>
#include <cmath>
#include <complex>

namespace chladni::identification {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// Imaginary parts of one mode at the sensors and at the actuators, with variances.
struct Sides {
  Eigen::VectorXd outputs, inputs, output_variance, input_variance;
};

Sides scaled_sides(const Matching& state, Index m) {
  const auto& complex = *state.fit.complex;
  const auto& told = state.match.modes[static_cast<std::size_t>(m)];
  const double alpha = told.alpha;
  return {complex.outputs.col(m).imag() / alpha,
          told.sign * alpha * complex.inputs.row(m).imag().transpose(),
          (complex.output_imaginary_std.col(m) / alpha).cwiseAbs2(),
          (complex.input_imaginary_std.row(m).transpose() * alpha).cwiseAbs2()};
}

// γ that gives L e^{−jγ} and R e^{jγ} the same phase at the pairs, within ±π/4; signs come later.
double phase_between(const Matching& state, Index m) {
  const auto& complex = *state.fit.complex;
  Complex sum = 0.0;
  for (const auto& pair : state.options.pairs) {
    if (!pair.is_one_place()) continue;
    Complex product = complex.outputs(pair.output, m) * std::conj(complex.inputs(m, pair.input));
    if (product.real() < 0.0) product = -product;
    sum += product;
  }
  return sum == 0.0 ? 0.0 : 0.5 * std::arg(sum);
}

// Jacobian of (ω, ζ, Re L, Re R, Im L, Im R) for shapes turned by e^{−jγ} and e^{jγ}.
Eigen::MatrixXd turning(Index p, Index q, double gamma) {
  const double c = std::cos(gamma);
  const double s = std::sin(gamma);
  Eigen::MatrixXd turn = Eigen::MatrixXd::Identity(2 + 2 * (p + q), 2 + 2 * (p + q));
  for (Index i = 0; i < p + q; ++i) {
    const double sine = i < p ? s : -s;
    const Index real = 2 + i;
    const Index imaginary = real + p + q;
    turn(real, real) = turn(imaginary, imaginary) = c;
    turn(real, imaginary) = sine;
    turn(imaginary, real) = -sine;
  }
  return turn;
}

void turn_mode(Matching& state, Index m, double gamma) {
  auto& fit = state.fit;
  auto& complex = *fit.complex;
  const Index p = state.p();
  const Index q = state.q();
  complex.outputs.col(m) *= std::polar(1.0, -gamma);
  complex.inputs.row(m) *= std::polar(1.0, gamma);
  fit.model.output_shapes.col(m) = complex.outputs.col(m).real();
  fit.model.input_shapes.row(m) = complex.inputs.row(m).real();
  const auto at = static_cast<std::size_t>(m);
  if (at >= complex.covariance.size() || complex.covariance[at].rows() != 2 + 2 * (p + q)) return;
  const auto turn = turning(p, q, gamma);
  complex.covariance[at] = turn * complex.covariance[at] * turn.transpose();
  fit.mode_covariance[at] = complex.covariance[at].topLeftCorner(2 + p + q, 2 + p + q);
  const Eigen::VectorXd deviation =
      complex.covariance[at].diagonal().tail(p + q).cwiseMax(0.0).cwiseSqrt();
  complex.output_imaginary_std.col(m) = deviation.head(p);
  complex.input_imaginary_std.row(m) = deviation.tail(q).transpose();
}

// Gives both sides of a pair one value, weighted by their variances; opposite ones where their
// directions are opposite.
void tie_pairs(const Matching& state, Sides& sides) {
  for (std::size_t c = 0; c < state.options.pairs.size(); ++c) {
    const auto& pair = state.options.pairs[c];
    if (!pair.is_one_place() || state.match.pairs[c].turned) continue;
    double& output = sides.outputs(pair.output);
    double& input = sides.inputs(pair.input);
    double& of_output = sides.output_variance(pair.output);
    double& of_input = sides.input_variance(pair.input);
    if (!(of_output > 0.0) || !(of_input > 0.0)) continue;
    const double both = 1.0 / (1.0 / of_output + 1.0 / of_input);
    output = both * (output / of_output + pair.sign * input / of_input);
    input = pair.sign * output;
    of_output = of_input = both;
  }
}

void add_mode(Matching& state, Index m) {
  auto sides = scaled_sides(state, m);
  tie_pairs(state, sides);
  auto& match = state.match;
  for (std::size_t k = 0; k < match.rows.size(); ++k) {
    const auto [actuator, channel] = match.rows[k];
    const auto row = static_cast<Index>(k);
    match.imaginary(row, m) = actuator ? sides.inputs(channel) : sides.outputs(channel);
    match.imaginary_deviation(row, m) =
        std::sqrt(actuator ? sides.input_variance(channel) : sides.output_variance(channel));
  }
  match.input_imaginary.row(m) = sides.inputs.transpose();
}

}  // namespace

void agree_in_phase(Matching& state) {
  if (!state.fit.complex) return;
  for (Index m = state.fit.model.rigid_count; m < state.fit.model.mode_count(); ++m) {
    turn_mode(state, m, phase_between(state, m));
  }
}

void add_imaginary_rows(Matching& state) {
  auto& match = state.match;
  if (!state.fit.complex) return;
  const auto n = static_cast<Index>(match.rows.size());
  const auto m = state.fit.model.mode_count();
  match.imaginary = match.imaginary_deviation = Eigen::MatrixXd::Zero(n, m);
  match.input_imaginary = Eigen::MatrixXd::Zero(m, state.q());
  for (Index k = state.fit.model.rigid_count; k < m; ++k) add_mode(state, k);
}

}  // namespace chladni::identification
