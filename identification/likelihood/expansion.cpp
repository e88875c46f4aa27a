#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "dense/algebra.h"
#include "identification/constants.h"
#include "identification/likelihood/compression.h"
#include "identification/likelihood/uncertainty/untold.h"

namespace chladni::identification {
namespace {

struct Sides {
  Eigen::VectorXd left;
  Eigen::RowVectorXd right;
  Eigen::MatrixXd covariance;  // of (ω, ζ, L, R)
};

// L and R of one mode from those of the small space, balanced and signed as in ModalFit.
Sides sides_of(const ModalFit& fit, const Compressed& small, Eigen::Index m) {
  const auto p = small.left.rows();
  const auto q = small.right.rows();
  const auto r = small.left.cols();
  Sides result{small.left * fit.model.output_shapes.col(m),
               fit.model.input_shapes.row(m) * small.right.transpose(),
               {}};
  const bool rigid = m < fit.model.rigid_count;
  double balance =
      rigid ? 1.0 : std::sqrt(result.right.norm() / std::max(1e-300, result.left.norm()));
  Eigen::Index largest = 0;
  result.left.cwiseAbs().maxCoeff(&largest);
  if (result.left(largest) < 0.0) balance = -balance;
  Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(2 + p + q, 2 + r + small.right.cols());
  turn.topLeftCorner(2, 2).setIdentity();
  turn.block(2, 2, p, r) = balance * small.left;
  turn.bottomRightCorner(q, small.right.cols()) = small.right / balance;
  result.left *= balance;
  result.right /= balance;
  if (!rigid) {  // the scale between both sides is fixed by their equal lengths
    Eigen::VectorXd along = Eigen::VectorXd::Zero(2 + p + q);
    along.segment(2, p) = result.left;
    along.tail(q) = -result.right.transpose();
    turn -= along * (along.transpose() * turn).eval() / along.squaredNorm();
  }
  result.covariance = turn * fit.mode_covariance[static_cast<std::size_t>(m)] * turn.transpose();
  return result;
}

// Adds the noise outside of the small space. For given modes and the other side, an entry of L has
// the variance 1 / (2 a² Σ c² |h|² Σ b² R²), except along the fitted directions.
void add_beside(const Compressed& small, double information, double variance, Sides& sides) {
  if (!(information > 0.0)) return;
  const auto p = small.left.rows();
  const auto q = small.right.rows();
  const auto part = [](const Eigen::VectorXd& scale, const Eigen::MatrixXd& basis) {
    const Eigen::VectorXd over =
        (scale.array() > 0.0).select(scale.cwiseInverse(), 0.0).cwiseAbs2();
    Eigen::MatrixXd beside = -basis * basis.transpose();
    beside.diagonal() += over;
    return beside;
  };
  const double inputs =
      (small.input_scale.array() * sides.right.transpose().array()).matrix().squaredNorm();
  const double outputs = (small.output_scale.array() * sides.left.array()).matrix().squaredNorm();
  if (!(inputs > 0.0) || !(outputs > 0.0)) return;
  sides.covariance.block(2, 2, p, p) +=
      part(small.output_scale, small.left) * (0.5 * variance / (information * inputs));
  sides.covariance.bottomRightCorner(q, q) +=
      part(small.input_scale, small.right) * (0.5 * variance / (information * outputs));
}

// Σ c² |h|² of a mode.
double information_of(const modal::ReducedModel& model, Eigen::Index m, const FitData& data) {
  const double own = 2.0 * std::numbers::pi * model.frequency_hz(m);
  const double ratio = model.damping_ratio(m);
  double sum = 0.0;
  for (Eigen::Index k = 0; k < data.line_count(); ++k) {
    const double omega = 2.0 * std::numbers::pi * data.frequency_hz(k);
    const double real = own * own - omega * omega;
    const double imaginary = 2.0 * ratio * own * omega;
    sum += std::pow(data.weight(k, 0), 2) / (real * real + imaginary * imaginary);
  }
  return sum;
}

// h = 1/(s² + 2ζωs + ω²) of every mode on every line, real above imaginary parts, without the best
// constant if there is a residual: 2K×n.
Eigen::MatrixXd fractions(const ModalFit& fit, const FitData& small, bool residual) {
  const auto lines = small.line_count();
  const auto n = fit.model.mode_count();
  const Eigen::ArrayXd omega = 2.0 * std::numbers::pi * small.frequency_hz.array();
  const Eigen::ArrayXd squared = small.weight.col(0).array().square();
  Eigen::MatrixXd result(2 * lines, n);
  for (Eigen::Index m = 0; m < n; ++m) {
    const double own = 2.0 * std::numbers::pi * fit.model.frequency_hz(m);
    const Eigen::ArrayXd real = own * own - omega.square();
    const Eigen::ArrayXd imaginary = 2.0 * fit.model.damping_ratio(m) * own * omega;
    const Eigen::ArrayXd square = real.square() + imaginary.square();
    result.col(m).head(lines) = real / square;
    result.col(m).tail(lines) = -imaginary / square;
    if (!residual) continue;
    const double mean = (result.col(m).head(lines).array() * squared).sum() / squared.sum();
    result.col(m).head(lines).array() -= mean;
  }
  return result;
}

// Σ c² Re h̄ G of every mode and response: n×pq.
Eigen::MatrixXd along_modes(const Eigen::MatrixXd& weighted, const FitData& data, double delay_s) {
  const auto lines = data.line_count();
  const auto p = data.outputs;
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(weighted.cols(), data.response_count());
  const Eigen::VectorXd angle = 2.0 * std::numbers::pi * delay_s * data.frequency_hz;
  Eigen::VectorXcd turn(lines);
  for (Eigen::Index k = 0; k < lines; ++k) turn(k) = std::polar(1.0, angle(k));
  Eigen::MatrixXd part(2 * lines, p);
  Eigen::MatrixXd product(weighted.cols(), p);
  const Eigen::MatrixXd rows = weighted.transpose();
  for (Eigen::Index j = 0; j < data.inputs; ++j) {
    const Eigen::MatrixXcd turned = turn.asDiagonal() * data.value.middleCols(j * p, p);
    part.topRows(lines) = turned.real();
    part.bottomRows(lines) = turned.imag();
    product.setZero();
    dense::add_product(rows, part, 1.0, product);
    result.middleCols(j * p, p) = product;
  }
  return result;
}

// Makes |L| = |R| for every flexible mode.
void balance(modal::ReducedModel& model) {
  for (auto m = model.rigid_count; m < model.mode_count(); ++m) {
    const double factor =
        std::sqrt(model.input_shapes.row(m).norm() / model.output_shapes.col(m).norm());
    model.output_shapes.col(m) *= factor;
    model.input_shapes.row(m) /= factor;
  }
}

// L and R of all channels by linear least squares for given poles, one side after the other. This
// adds the part of the shapes outside of the small space.
void refine_shapes(const Compressed& small, const FitData& data, bool residual, ModalFit& fit) {
  const auto lines = data.line_count();
  const auto p = data.outputs;
  const auto h = fractions(fit, small.data, residual);
  const Eigen::VectorXd squared = small.data.weight.col(0).cwiseAbs2();
  Eigen::MatrixXd weighted = h;
  weighted.topRows(lines) = squared.asDiagonal() * h.topRows(lines);
  weighted.bottomRows(lines) = squared.asDiagonal() * h.bottomRows(lines);
  const Eigen::MatrixXd gram = h.transpose() * weighted;
  const auto along = along_modes(weighted, data, fit.delay_s);
  const Eigen::VectorXd a = small.output_scale.cwiseAbs2();
  const Eigen::VectorXd b = small.input_scale.cwiseAbs2();
  auto& left = fit.model.output_shapes;
  auto& right = fit.model.input_shapes;
  const auto solved = [](const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& sides) {
    const Eigen::VectorXd unit = matrix.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = unit.asDiagonal() * matrix * unit.asDiagonal();
    return Eigen::MatrixXd(unit.asDiagonal() * Eigen::LDLT<Eigen::MatrixXd>(scaled).solve(
                                                   Eigen::MatrixXd(unit.asDiagonal() * sides)));
  };
  for (int round = 0; round < Constants::expansion_rounds; ++round) {
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(left.cols(), p);
    for (Eigen::Index j = 0; j < data.inputs; ++j) {
      sums += b(j) * right.col(j).asDiagonal() * along.middleCols(j * p, p);
    }
    left = solved(gram.cwiseProduct(right * b.asDiagonal() * right.transpose()), sums).transpose();
    left = (a.array() > 0.0).cast<double>().matrix().asDiagonal() * left;
    for (Eigen::Index j = 0; j < data.inputs; ++j) {
      right.col(j) = (along.middleCols(j * p, p) * a.asDiagonal())
                         .cwiseProduct(left.transpose())
                         .rowwise()
                         .sum();
    }
    right = solved(gram.cwiseProduct(left.transpose() * a.asDiagonal() * left), right);
    right = right * (b.array() > 0.0).cast<double>().matrix().asDiagonal();
  }
  balance(fit.model);
}

// Residual with its deviation, and the cost of all responses; handles one input at a time.
void fill_residual(const FitData& data, bool wanted, double variance, ModalFit& fit) {
  const auto p = data.outputs;
  modal::ReducedModel one = fit.model;
  fit.model.residual = Eigen::MatrixXd::Zero(p, data.inputs);
  fit.residual_std = Eigen::MatrixXd::Zero(p, data.inputs);
  fit.cost = 0.0;
  for (Eigen::Index j = 0; j < data.inputs; ++j) {
    ModalFit part;
    one.input_shapes = fit.model.input_shapes.col(j);
    one.residual = Eigen::MatrixXd::Zero(p, 1);
    part.model = one;
    part.delay_s = fit.delay_s;
    Eigen::MatrixXcd error = data.value.middleCols(j * p, p) - responses(part, data.frequency_hz);
    const Eigen::VectorXd angle = 2.0 * std::numbers::pi * fit.delay_s * data.frequency_hz;
    for (Eigen::Index k = 0; k < error.rows(); ++k) error.row(k) *= std::polar(1.0, angle(k));
    for (Eigen::Index i = 0; i < p; ++i) {
      const Eigen::ArrayXd squared = data.weight.col(i + p * j).array().square();
      const double sum = squared.sum();
      if (wanted && sum > 0.0) {
        const double best = (error.col(i).real().array() * squared).sum() / sum;
        error.col(i).array() -= best;
        fit.model.residual(i, j) = best;
        fit.residual_std(i, j) = std::sqrt(0.5 * variance / sum);
      }
      fit.cost += (error.col(i).cwiseAbs2().array() * squared).sum();
    }
  }
}

// Covariance of (vec L, vec R) of all rigid-body modes together.
Eigen::MatrixXd rigid_covariance(const ModalFit& fit, const Compressed& small) {
  const auto g = fit.model.rigid_count;
  if (g == 0) return {};
  const auto p = small.left.rows();
  const auto q = small.right.rows();
  const auto r = small.left.cols();
  const auto s = small.right.cols();
  Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(g * (p + q), g * (r + s));
  for (Eigen::Index a = 0; a < g; ++a) {
    turn.block(a * p, a * r, p, r) = small.left;
    for (Eigen::Index j = 0; j < q; ++j) {
      for (Eigen::Index b = 0; b < s; ++b)
        turn(g * p + a + g * j, g * r + a + g * b) = small.right(j, b);
    }
  }
  return turn * fit.rigid_covariance * turn.transpose();
}

}  // namespace

ModalFit expanded(const ModalFit& fit, const Compressed& small, const FitData& data) {
  ModalFit result = fit;
  const auto p = data.outputs;
  const auto q = data.inputs;
  const auto n = fit.model.mode_count();
  const double variance = noise_level(fit, small.data) * variance_factor(small.data);
  result.model.output_shapes.resize(p, n);
  result.model.input_shapes.resize(n, q);
  result.output_std.resize(p, n);
  result.input_std.resize(n, q);
  for (Eigen::Index m = 0; m < n; ++m) {
    auto sides = sides_of(fit, small, m);
    add_beside(small, information_of(fit.model, m, small.data), variance, sides);
    result.model.output_shapes.col(m) = sides.left;
    result.model.input_shapes.row(m) = sides.right;
    const Eigen::VectorXd deviation = sides.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    result.output_std.col(m) = deviation.segment(2, p);
    result.input_std.row(m) = deviation.tail(q).transpose();
    result.mode_covariance[static_cast<std::size_t>(m)] = std::move(sides.covariance);
  }
  result.rigid_covariance = rigid_covariance(fit, small);
  const auto g = fit.model.rigid_count;
  const bool residual = fit.residual_std.size() > 0 && fit.residual_std.maxCoeff() > 0.0;
  result.measured_count = data.measured_count();
  result.parameter_count = (n - g) * (p + q + 1) + g * (p + q - g) +
                           (fit.delay_std_s > 0.0 ? 1 : 0) +
                           (residual ? (data.weight.colwise().sum().array() > 0.0).count() : 0);
  const auto expected = expected_cost(data, result.parameter_count);
  result.expected_cost = expected.mean;
  result.cost_deviation = expected.deviation;
  refine_shapes(small, data, residual, result);
  fill_residual(data, residual, variance, result);
  mark_unmeasured(data.weight.colwise().sum().reshaped(p, q), result);
  return result;
}

}  // namespace chladni::identification
