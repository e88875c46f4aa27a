#include "identification/likelihood/compression.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/draw.h"
#include "base/finite.h"
#include "dense/algebra.h"
#include "identification/constants.h"

namespace chladni::identification {
namespace {

struct Scales {
  Eigen::VectorXd output, input, line;  // 0: not measured
  bool separable = true;
};

// Geometric means of the weights along each axis.
Scales scales(const FitData& data) {
  const auto p = data.outputs;
  const auto lines = data.line_count();
  Scales result{Eigen::VectorXd::Zero(p), Eigen::VectorXd::Zero(data.inputs),
                Eigen::VectorXd::Zero(lines), true};
  Eigen::ArrayXXd mean = Eigen::ArrayXXd::Zero(p, data.inputs);
  Eigen::ArrayXd line = Eigen::ArrayXd::Zero(lines);
  Eigen::Index responses = 0;
  for (Eigen::Index e = 0; e < data.response_count(); ++e) {
    const auto w = data.weight.col(e).array();
    const auto measured = (w > 0.0).count();
    if (measured == 0) continue;
    if (measured < lines) return {{}, {}, {}, false};
    const Eigen::ArrayXd logarithm = w.log();
    mean(e % p, e / p) = logarithm.mean();
    result.output(e % p) += 1.0;
    result.input(e / p) += 1.0;
    line += logarithm - logarithm.mean();
    ++responses;
  }
  const auto outputs = (result.output.array() > 0.0).count();
  const auto inputs = (result.input.array() > 0.0).count();
  if (responses == 0 || outputs * inputs != responses) return {{}, {}, {}, false};
  line /= static_cast<double>(responses);
  const double all = mean.sum() / static_cast<double>(responses);
  const Eigen::ArrayXd rows = mean.rowwise().sum() / static_cast<double>(inputs);
  const Eigen::ArrayXd columns = mean.colwise().sum().transpose() / static_cast<double>(outputs);
  result.output = (result.output.array() > 0.0).select((rows - 0.5 * all).exp(), 0.0);
  result.input = (result.input.array() > 0.0).select((columns - 0.5 * all).exp(), 0.0);
  result.line = line.exp();
  double square = 0.0;
  for (Eigen::Index e = 0; e < data.response_count(); ++e) {
    if (result.output(e % p) * result.input(e / p) == 0.0) continue;
    const double own = rows(e % p) + columns(e / p) - all;
    square += (data.weight.col(e).array().log() - line - own).square().mean();
  }
  result.separable = std::sqrt(square / static_cast<double>(responses)) < Constants::separable;
  return result;
}

// Whitened responses of some columns of the data, real above imaginary parts: 2K×columns.
Eigen::MatrixXd whitened(const FitData& data, const Scales& scale, Eigen::Index first,
                         Eigen::Index step, Eigen::Index count, bool by_line) {
  const auto lines = data.line_count();
  Eigen::MatrixXd result(2 * lines, count);
  for (Eigen::Index c = 0; c < count; ++c) {
    const auto e = first + c * step;
    const double factor = scale.output(e % data.outputs) * scale.input(e / data.outputs);
    const auto value = data.value.col(e).array() * factor;
    if (by_line) {
      result.col(c).head(lines) = value.real() * scale.line.array();
      result.col(c).tail(lines) = value.imag() * scale.line.array();
    } else {
      result.col(c).head(lines) = value.real();
      result.col(c).tail(lines) = value.imag();
    }
  }
  return result;
}

// Directions of one side that exceed noise alone. The other side has `others` channels.
Eigen::MatrixXd directions(const Eigen::MatrixXd& square, Eigen::Index lines, Eigen::Index others,
                           bool noise_known) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      finite(Eigen::MatrixXd(square.selfadjointView<Eigen::Lower>()), "products of the responses"));
  const auto size = square.rows();
  const auto numbers = static_cast<double>(2 * lines * others);
  // Expected eigenvalue of noise: half of the number of values, since each has a variance of 1/2.
  const double level = noise_known ? 0.5 * numbers : solver.eigenvalues()(size / 4);
  const double edge = std::pow(1.0 + std::sqrt(static_cast<double>(size) / numbers), 2);
  Eigen::Index count = 0;
  while (count < std::min(size, Constants::most_directions) &&
         solver.eigenvalues()(size - 1 - count) > Constants::above_noise * edge * level) {
    ++count;
  }
  return solver.eigenvectors().rightCols(std::max<Eigen::Index>(count, 1)).rowwise().reverse();
}

Eigen::MatrixXd random_basis(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  Draw draw(seed);
  Eigen::MatrixXd all(rows, columns);
  for (double& value : all.reshaped()) value = draw.normal();
  return dense::orthonormal_basis(all);
}

// leftᵀ G right of every line, as fit data with the weights of the lines.
FitData projected(const std::vector<Eigen::MatrixXd>& by_input, const Eigen::MatrixXd& right,
                  const FitData& like, const Eigen::VectorXd& line_weight) {
  const auto lines = like.line_count();
  const auto rows = by_input.front().cols();
  Eigen::MatrixXd all(2 * lines * rows, right.rows());
  for (Eigen::Index j = 0; j < right.rows(); ++j) {
    all.col(j) = by_input[static_cast<std::size_t>(j)].reshaped();
  }
  Eigen::MatrixXd z = Eigen::MatrixXd::Zero(all.rows(), right.cols());
  dense::add_product(all, right, 1.0, z);
  FitData result{.outputs = rows,
                 .inputs = right.cols(),
                 .frequency_hz = like.frequency_hz,
                 .value = {},
                 .weight = {},
                 .noise_known = like.noise_known,
                 .noise_stated = like.noise_stated,
                 .freedom_known = like.freedom_known,
                 .noise_freedom = like.noise_freedom,
                 .shared_lines = like.shared_lines,
                 .model_error = like.model_error,
                 .error_share = like.error_share};
  result.value.resize(lines, rows * right.cols());
  for (Eigen::Index e = 0; e < result.value.cols(); ++e) {
    const auto column = z.col(e / rows).segment(2 * lines * (e % rows), 2 * lines);
    result.value.col(e).real() = column.head(lines);
    result.value.col(e).imag() = column.tail(lines);
  }
  result.weight = line_weight.replicate(1, result.value.cols());
  return result;
}

}  // namespace

std::optional<Compressed> compressed(const FitData& data) {
  const auto scale = scales(data);
  if (!scale.separable) return std::nullopt;
  const auto p = data.outputs;
  const auto q = data.inputs;
  const auto lines = data.line_count();
  Eigen::MatrixXd outputs = Eigen::MatrixXd::Zero(p, p);
  Eigen::MatrixXd inputs = Eigen::MatrixXd::Zero(q, q);
  for (Eigen::Index j = 0; j < q; ++j) {
    dense::add_square(whitened(data, scale, j * p, 1, p, true).transpose(), 1.0, outputs);
  }
  for (Eigen::Index i = 0; i < p; ++i) {
    dense::add_square(whitened(data, scale, i, p, q, true).transpose(), 1.0, inputs);
  }
  const Eigen::MatrixXd u = directions(outputs, lines, q, data.noise_known);
  const Eigen::MatrixXd v = directions(inputs, lines, p, data.noise_known);
  std::vector<Eigen::MatrixXd> by_input;
  for (Eigen::Index j = 0; j < q; ++j) {
    Eigen::MatrixXd part = Eigen::MatrixXd::Zero(2 * lines, u.cols());
    dense::add_product(whitened(data, scale, j * p, 1, p, false), u, 1.0, part);
    by_input.push_back(std::move(part));
  }
  const auto over = [](const Eigen::VectorXd& a) {
    return Eigen::VectorXd((a.array() > 0.0).select(a.cwiseInverse(), 0.0));
  };
  return Compressed{projected(by_input, v, data, scale.line),
                    over(scale.output).asDiagonal() * u,
                    over(scale.input).asDiagonal() * v,
                    u.transpose() * scale.output.asDiagonal(),
                    v.transpose() * scale.input.asDiagonal(),
                    scale.output,
                    scale.input};
}

FitData sketched(const FitData& data, Eigen::Index size) {
  if (data.outputs <= size && data.inputs <= size) return data;
  const auto rows = std::min(size, data.outputs);
  const Eigen::MatrixXd left = random_basis(data.outputs, rows, 1);
  const Eigen::MatrixXd right = random_basis(data.inputs, std::min(size, data.inputs), 2);
  const auto lines = data.line_count();
  std::vector<Eigen::MatrixXd> by_input;
  for (Eigen::Index j = 0; j < data.inputs; ++j) {
    const auto part = data.value.middleCols(j * data.outputs, data.outputs);
    Eigen::MatrixXd one(2 * lines, rows);
    one.topRows(lines) = part.real() * left;
    one.bottomRows(lines) = part.imag() * left;
    by_input.push_back(std::move(one));
  }
  return projected(by_input, right, data, data.weight.col(0));
}

}  // namespace chladni::identification
