#include "identification/normal_equations.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "identification/response_products.h"
#include "priors/dense.h"

namespace chladni::identification {
namespace {

using Complex = std::complex<double>;
namespace dense = priors::dense;

// Entries of H of all blocks; a rigid block has 1/s² alone.
Eigen::Index entry_count(const Block& block) {
  return block.rigid ? 1 : block.size() * block.size();
}

// H = (s² + sD + K)⁻¹ of every block on every line: entries×2K.
Eigen::MatrixXd entries(const BlockModel& model, const Eigen::VectorXd& x) {
  Eigen::Index count = 0;
  for (const auto& block : model.blocks) count += entry_count(block);
  const auto lines = x.size();
  Eigen::MatrixXd result(count, 2 * lines);
  for (Eigen::Index k = 0; k < lines; ++k) {
    const Complex s(0.0, x(k));
    Eigen::Index at = 0;
    const auto put = [&](Complex value) {
      result(at, k) = value.real();
      result(at++, lines + k) = value.imag();
    };
    for (const auto& block : model.blocks) {
      if (block.rigid) {
        put(1.0 / (s * s));
      } else if (block.size() == 1) {
        put(1.0 / (s * s + s * block.damping(0, 0) + block.stiffness(0, 0)));
      } else {
        const auto g = block.size();
        const Eigen::MatrixXcd dynamic = s * s * Eigen::MatrixXcd::Identity(g, g) +
                                         s * block.damping.cast<Complex>() +
                                         block.stiffness.cast<Complex>();
        const Eigen::MatrixXcd h = dynamic.inverse();
        for (const auto& value : h.reshaped()) put(value);
      }
    }
  }
  return result;
}

// What multiplies them in every response: pq×entries.
Eigen::MatrixXd factors(const BlockModel& model, Eigen::Index outputs, Eigen::Index inputs) {
  Eigen::Index count = 0;
  for (const auto& block : model.blocks) count += entry_count(block);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(outputs * inputs, count);
  Eigen::Index first = 0;
  for (const auto& block : model.blocks) {
    const auto g = block.size();
    for (Eigen::Index b = 0; b < g; ++b) {
      for (Eigen::Index a = 0; a < g; ++a) {
        if (block.rigid && a != b) continue;
        const Eigen::MatrixXd product = block.left.col(a) * block.right.row(b);
        result.col(first + (block.rigid ? 0 : a + g * b)) += product.reshaped();
      }
    }
    first += entry_count(block);
  }
  return result;
}

Eigen::Index parameters_of(const Block& block) {
  const auto g = block.size();
  return g * (block.left.rows() + block.right.cols()) + (block.rigid ? 0 : 2 * g * g);
}

// The data turned back by the delay: value · e^{+s delay}.
Eigen::MatrixXd undelayed(const Target& target, double delay) {
  if (delay == 0.0) return target.value;
  const auto lines = target.line_count();
  Eigen::MatrixXd result(target.value.rows(), 2 * lines);
  for (Eigen::Index k = 0; k < lines; ++k) {
    const double c = std::cos(target.x(k) * delay);
    const double s = std::sin(target.x(k) * delay);
    result.col(k) = c * target.value.col(k) - s * target.value.col(lines + k);
    result.col(lines + k) = s * target.value.col(k) + c * target.value.col(lines + k);
  }
  return result;
}

}  // namespace

Target target(const FitData& data, double scale) {
  Target result{
      .outputs = data.outputs, .inputs = data.inputs, .x = {}, .value = {}, .squared = {}};
  const auto lines = data.line_count();
  result.x = 2.0 * std::numbers::pi / scale * data.frequency_hz;
  result.value.resize(data.response_count(), 2 * lines);
  result.value.leftCols(lines) = data.value.real().transpose();
  result.value.rightCols(lines) = data.value.imag().transpose();
  result.squared = data.weight.cwiseAbs2().transpose();
  result.measured = std::max<Eigen::Index>(1, data.measured_count());
  result.total = data.value.cwiseAbs2().cwiseProduct(data.weight.cwiseAbs2()).sum();
  return result;
}

Misfit misfit(BlockModel& model, const Target& target, const Fitted& fitted) {
  Misfit result;
  const auto lines = target.line_count();
  result.response.setZero(target.response_count(), 2 * lines);
  dense::add_product(factors(model, target.outputs, target.inputs), entries(model, target.x), 1.0,
                     result.response);
  result.error = undelayed(target, model.delay) - result.response;
  if (fitted.residual) {
    const Eigen::VectorXd best =
        (result.error.leftCols(lines).cwiseProduct(target.squared)).rowwise().sum().array() /
        target.squared.rowwise().sum().array().max(1e-300);
    result.error.leftCols(lines).colwise() -= best;
    result.response.leftCols(lines).colwise() += best;
    model.residual = best.reshaped(target.outputs, target.inputs);
  }
  result.cost =
      (result.error.leftCols(lines).cwiseAbs2() + result.error.rightCols(lines).cwiseAbs2())
          .cwiseProduct(target.squared)
          .sum();
  return result;
}

NormalEquations normal_equations(const BlockModel& model, const Misfit& misfit,
                                 const Target& target, const Fitted& fitted) {
  const auto n = parameter_count(model, fitted);
  NormalEquations sum{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  const ResponseProducts products(model, misfit, target, fitted);
  const dense::OneThread one_thread;
  // Shares of the responses that do not depend on the threads, added in order: the same bits on
  // any number of cores.
  const auto count = static_cast<std::size_t>(target.response_count());
  const std::size_t shares = std::min<std::size_t>(count, 8);
  std::vector<NormalEquations> parts(shares);
  const auto cores = static_cast<std::size_t>(thread_count());
  for (std::size_t first = 0; first < shares; first += cores) {
    parallel_ranges(std::min(cores, shares - first), [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = first + begin; t < first + end; ++t) {
        parts[t] = {Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
        products.add(static_cast<Eigen::Index>(t * count / shares),
                     static_cast<Eigen::Index>((t + 1) * count / shares), parts[t]);
      }
    });
    for (std::size_t t = first; t < std::min(first + cores, shares); ++t) {
      sum.matrix += parts[t].matrix;
      sum.gradient += parts[t].gradient;
      parts[t] = {};
    }
  }
  return sum;
}

Eigen::Index parameter_count(const BlockModel& model, const Fitted& fitted) {
  Eigen::Index count = fitted.delay ? 1 : 0;
  for (const auto& block : model.blocks) count += parameters_of(block);
  return count;
}

BlockModel moved(const BlockModel& model, const Eigen::VectorXd& step, const Fitted& fitted) {
  BlockModel result = model;
  Eigen::Index at = 0;
  const auto take = [&](Eigen::MatrixXd& part) {
    part += Eigen::Map<const Eigen::MatrixXd>(step.data() + at, part.rows(), part.cols());
    at += part.size();
  };
  for (auto& block : result.blocks) {
    take(block.left);
    take(block.right);
    if (!block.rigid) {
      take(block.stiffness);
      take(block.damping);
    }
    block = balanced(block);
  }
  if (fitted.delay) result.delay += step(at);
  return result;
}

}  // namespace chladni::identification
