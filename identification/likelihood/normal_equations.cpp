#include "identification/likelihood/normal_equations.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "dense/algebra.h"
#include "dense/blas.h"
#include "host/parallel.h"
#include "identification/likelihood/equal_weights.h"
#include "identification/likelihood/response_products.h"

namespace chladni::identification {
namespace {

using Complex = std::complex<double>;
// Number of different entries of H of a block. A rigid block has only 1/s², a general one (s − σ)/d
// and ω/d with d = (s − σ)² + ω².
Eigen::Index entry_count(const Block& block) {
  if (block.general) return 2;
  return block.rigid ? 1 : block.size() * block.size();
}

// H = (s² + sD + K)⁻¹ of every block on every line: 2K×entries.
Eigen::MatrixXd entries(const BlockModel& model, const Eigen::VectorXd& x) {
  Eigen::Index count = 0;
  for (const auto& block : model.blocks) count += entry_count(block);
  const auto lines = x.size();
  Eigen::MatrixXd result(2 * lines, count);
  for (Eigen::Index k = 0; k < lines; ++k) {
    const Complex s(0.0, x(k));
    Eigen::Index at = 0;
    const auto put = [&](Complex value) {
      result(k, at) = value.real();
      result(lines + k, at++) = value.imag();
    };
    for (const auto& block : model.blocks) {
      if (block.rigid) {
        put(1.0 / (s * s));
      } else if (block.general) {
        const Complex from = s - block.pole.real();
        const Complex over = 1.0 / (from * from + block.pole.imag() * block.pole.imag());
        put(from * over);
        put(block.pole.imag() * over);
      } else if (block.size() == 1) {
        const double real = block.stiffness(0, 0) - x(k) * x(k);
        const double imaginary = x(k) * block.damping(0, 0);
        const double square = real * real + imaginary * imaginary;
        put({real / square, -imaginary / square});
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

// Factors of these entries in every response: entries×pq.
Eigen::MatrixXd factors(const BlockModel& model, Eigen::Index outputs, Eigen::Index inputs) {
  Eigen::Index count = 0;
  for (const auto& block : model.blocks) count += entry_count(block);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(count, outputs * inputs);
  Eigen::Index first = 0;
  for (const auto& block : model.blocks) {
    const auto g = block.size();
    for (Eigen::Index b = 0; b < g; ++b) {
      for (Eigen::Index a = 0; a < g; ++a) {
        if (block.rigid && a != b) continue;
        Eigen::MatrixXd product = block.left.col(a) * block.right.row(b);
        auto row = first + (block.rigid ? 0 : a + g * b);
        if (block.general) {  // (s − A)⁻¹ = [s − σ, ω; −ω, s − σ] / d
          row = first + (a == b ? 0 : 1);
          if (a > b) product *= -1.0;
        }
        result.row(row) += product.reshaped().transpose();
      }
    }
    first += entry_count(block);
  }
  return result;
}

// The data without the delays: value · e^{+s delay}.
Eigen::MatrixXd undelayed(const Target& target, const BlockModel& model, const Fitted& fitted) {
  const bool own = model.channel_delay.size() > 0;
  if (model.delay == 0.0 && !own) return target.value;
  const auto lines = target.line_count();
  Eigen::ArrayXd c = (target.x.array() * model.delay).cos();
  Eigen::ArrayXd s = (target.x.array() * model.delay).sin();
  Eigen::MatrixXd result(2 * lines, target.value.cols());
  for (Eigen::Index e = 0; e < result.cols(); ++e) {
    if (own) {
      const double delay = model.delay + model.channel_delay(fitted.delay_index(e, target.outputs));
      c = (target.x.array() * delay).cos();
      s = (target.x.array() * delay).sin();
    }
    const auto real = target.value.col(e).head(lines).array();
    const auto imaginary = target.value.col(e).tail(lines).array();
    result.col(e).head(lines) = c * real - s * imaginary;
    result.col(e).tail(lines) = s * real + c * imaginary;
  }
  return result;
}

}  // namespace

double Target::noise_level(double cost) const { return std::max(cost / expected_cost, 1e-300); }

Target target(const FitData& data, double scale) {
  Target result{
      .outputs = data.outputs, .inputs = data.inputs, .x = {}, .value = {}, .squared = {}};
  const auto lines = data.line_count();
  result.x = 2.0 * std::numbers::pi / scale * data.frequency_hz;
  result.value.resize(2 * lines, data.response_count());
  result.value.topRows(lines) = data.value.real();
  result.value.bottomRows(lines) = data.value.imag();
  result.squared = data.weight.cwiseAbs2();
  result.expected_cost = std::max(0.5, expected_cost(data, 0).mean);
  result.total = data.value.cwiseAbs2().cwiseProduct(data.weight.cwiseAbs2()).sum();
  return result;
}

Misfit misfit(BlockModel& model, const Target& target, const Fitted& fitted) {
  Misfit result;
  const auto lines = target.line_count();
  const auto along = entries(model, target.x);
  const auto across = factors(model, target.outputs, target.inputs);
  result.error = undelayed(target, model, fitted);
  dense::add_product(along, across, -1.0, result.error);
  if (fitted.delay) {
    result.response.setZero(2 * lines, target.response_count());
    dense::add_product(along, across, 1.0, result.response);
  }
  for (Eigen::Index e = 0; e < result.error.cols(); ++e) {
    auto real = result.error.col(e).head(lines).array();
    const auto imaginary = result.error.col(e).tail(lines).array();
    const auto squared = target.squared.col(e).array();
    if (fitted.residual) {
      const double best = (real * squared).sum() / std::max(squared.sum(), 1e-300);
      real -= best;
      if (fitted.delay) result.response.col(e).head(lines).array() += best;
      model.residual(e % target.outputs, e / target.outputs) = best;
    }
    result.cost += ((real.square() + imaginary.square()) * squared).sum();
  }
  return result;
}

NormalEquations normal_equations(const BlockModel& model, const Misfit& misfit,
                                 const Target& target, const Fitted& fitted) {
  return equal_weights_pay(model, target)
             ? normal_equations_of_equal_weights(model, misfit, target, fitted)
             : normal_equations_by_response(model, misfit, target, fitted);
}

NormalEquations normal_equations_by_response(const BlockModel& model, const Misfit& misfit,
                                             const Target& target, const Fitted& fitted) {
  const auto n = parameter_count(model, fitted);
  NormalEquations sum{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  const ResponseProducts products(model, misfit, target, fitted);
  const dense::OneBlasThread one_thread;
  // The shares of the responses do not depend on the threads and are added in order, so any number
  // of cores gives the same bits.
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
      sum.matrix.triangularView<Eigen::Lower>() += parts[t].matrix;
      sum.gradient += parts[t].gradient;
      parts[t] = {};
    }
  }
  return sum;
}

Eigen::Index parameter_count(const Block& block) {
  const auto g = block.size();
  const auto sides = g * (block.left.rows() + block.right.cols());
  if (block.general) return sides + 2;
  return sides + (block.rigid ? 0 : 2 * g * g);
}

Eigen::Index parameter_count(const BlockModel& model, const Fitted& fitted) {
  if (model.blocks.empty()) return 0;
  const auto& first = model.blocks.front();
  Eigen::Index count = fitted.delay_count(first.left.rows(), first.right.cols());
  for (const auto& block : model.blocks) count += parameter_count(block);
  return count;
}

BlockModel moved(const BlockModel& model, const Eigen::VectorXd& step, const Fitted& fitted) {
  BlockModel result = model;
  Eigen::Index at = 0;
  const auto take = [&](Eigen::MatrixXd& part) {
    part += Eigen::Map<const Eigen::MatrixXd>(step.data() + at, part.rows(), part.cols());
    at += part.size();
  };
  for (std::size_t b = 0; b < result.blocks.size(); ++b) {
    auto& block = result.blocks[b];
    take(block.left);
    take(block.right);
    if (block.general) {
      block.pole += std::complex<double>(step(at), step(at + 1));
      at += 2;
    } else if (!block.rigid) {
      take(block.stiffness);
      take(block.damping);
    }
    block = balanced(damped_after(std::move(block), model.blocks[b]));
  }
  if (!fitted.delay) return result;
  if (fitted.delay_of == DelayOf::all) {
    result.delay += step(at);
  } else {
    result.channel_delay += step.tail(step.size() - at);
  }
  return result;
}

}  // namespace chladni::identification
