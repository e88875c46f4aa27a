#include "identification/fit_uncertainty.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <sstream>

#include "identification/general_mode.h"
#include "priors/dense.h"

namespace chladni::identification {
namespace {

namespace dense = priors::dense;

constexpr double kUnknownShape = 0.15;  // relative deviation of a shape that cannot be told apart

double own_frequency(const Block& block) {
  if (block.general) return std::abs(block.pole);
  return block.rigid ? 0.0 : std::sqrt(block.stiffness(0, 0));
}

// Single modes by frequency, and how many of each block stayed together.
BlockModel in_modes(const BlockModel& model, std::vector<std::string>& notes) {
  BlockModel result = model;
  result.blocks.clear();
  for (const auto& block : model.blocks) {
    if (block.general) {
      result.blocks.push_back(turned(block));
      continue;
    }
    if (block.rigid || block.size() == 1) {
      result.blocks.push_back(balanced(block));
      continue;
    }
    const auto modes = forced_modes(block);
    std::ostringstream text;
    text << "modes near " << own_frequency(modes.front()) * model.scale / (2.0 * std::numbers::pi)
         << " Hz: their damping couples them, real modes of their own do not fit the data";
    notes.push_back(text.str());
    for (const auto& mode : modes) result.blocks.push_back(balanced(mode));
  }
  std::stable_sort(result.blocks.begin(), result.blocks.end(), [](const Block& a, const Block& b) {
    return own_frequency(a) < own_frequency(b);
  });
  for (auto& block : result.blocks) {
    for (Eigen::Index a = 0; a < block.size() && !block.general; ++a) {
      Eigen::Index largest = 0;
      block.left.col(a).cwiseAbs().maxCoeff(&largest);
      if (block.left(largest, a) < 0.0) {
        block.left.col(a) *= -1.0;
        block.right.row(a) *= -1.0;
      }
    }
  }
  return result;
}

// What the basis of a block may be changed by.
std::vector<Eigen::MatrixXd> idle_changes(const Block& block) {
  if (block.general) {  // what A commutes with
    return {Eigen::MatrixXd::Identity(2, 2), Eigen::MatrixXd{{0.0, 1.0}, {-1.0, 0.0}}};
  }
  const auto g = block.size();
  std::vector<Eigen::MatrixXd> all;
  for (Eigen::Index b = 0; b < g; ++b) {
    for (Eigen::Index a = 0; a < g; ++a) {
      all.emplace_back(Eigen::MatrixXd::Zero(g, g));
      all.back()(a, b) = 1.0;
    }
  }
  return all;
}

// Columns: directions in the parameters that leave every response as it is.
Eigen::MatrixXd idle_directions(const BlockModel& model, Eigen::Index parameters) {
  Eigen::Index count = 0;
  for (const auto& block : model.blocks) {
    count += block.general ? 2 : block.size() * block.size();
  }
  Eigen::MatrixXd idle = Eigen::MatrixXd::Zero(parameters, count);
  Eigen::Index column = 0;
  Eigen::Index first = 0;
  for (const auto& block : model.blocks) {
    const auto g = block.size();
    const auto p = block.left.rows();
    for (const auto& change : idle_changes(block)) {  // left += left T, right −= T right
      idle.col(column).segment(first, g * p) = (block.left * change).reshaped();
      idle.col(column++).segment(first + g * p, g * block.right.cols()) =
          -(change * block.right).reshaped();
    }
    first += parameter_count(block);
  }
  return idle;
}

// Pseudo-inverse of the normal equations that holds the idle directions still, orthogonally to
// them in the parameters' own metric.
Eigen::MatrixXd held_inverse(const NormalEquations& normal, const Eigen::MatrixXd& idle) {
  const Eigen::VectorXd scale =
      (normal.matrix.diagonal().array() > 0.0)
          .select(normal.matrix.diagonal().cwiseSqrt().cwiseInverse(), 0.0);
  Eigen::MatrixXd a = scale.asDiagonal() *
                      Eigen::MatrixXd(normal.matrix.selfadjointView<Eigen::Lower>()) *
                      scale.asDiagonal();
  // No data speak of a row that is not measured: it is kept out, its deviation is infinite.
  const Eigen::VectorXd known = (scale.array() > 0.0).cast<double>();
  const Eigen::MatrixXd scaled =
      (normal.matrix.diagonal().array().max(0.0).sqrt() * known.array()).matrix().asDiagonal() *
      idle;
  a.diagonal() += Eigen::VectorXd::Ones(known.size()) - known;
  const Eigen::MatrixXd q = Eigen::HouseholderQR<Eigen::MatrixXd>(scaled).householderQ() *
                            Eigen::MatrixXd::Identity(idle.rows(), idle.cols());
  a += q * q.transpose();
  Eigen::MatrixXd factor = a;
  for (double jitter = 1e-14; !dense::cholesky(factor); jitter *= 10.0) {
    factor = a;
    factor.diagonal().array() += jitter;
  }
  dense::invert(factor);
  factor.triangularView<Eigen::StrictlyUpper>() = factor.transpose();
  const Eigen::MatrixXd inverse = scale.asDiagonal() * factor * scale.asDiagonal();
  const Eigen::MatrixXd own = Eigen::HouseholderQR<Eigen::MatrixXd>(idle).householderQ() *
                              Eigen::MatrixXd::Identity(idle.rows(), idle.cols());
  const Eigen::MatrixXd half = inverse - own * (own.transpose() * inverse);
  return half - (half * own) * own.transpose();
}

// Rows of (ω, ζ, L, R) of a single mode in its parameters (L, R, K, D), physical units.
Eigen::MatrixXd physical(const Block& block, double scale) {
  const auto pq = block.left.rows() + block.right.cols();
  const double own = own_frequency(block);
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(2 + pq, pq + 2);
  jacobian(0, pq) = scale / (2.0 * own);
  jacobian(1, pq) = -block.damping(0, 0) / (4.0 * own * own * own);
  jacobian(1, pq + 1) = 1.0 / (2.0 * own);
  jacobian.bottomLeftCorner(pq, pq) = scale * Eigen::MatrixXd::Identity(pq, pq);
  return jacobian;
}

class Filler {
 public:
  Filler(const BlockModel& model, const Eigen::MatrixXd& covariance, ModalFit& fit)
      : model_(model), covariance_(covariance), fit_(fit) {}

  void fill() {
    for (const auto& block : model_.blocks) {
      if (block.rigid) {
        add_rigid(block);
      } else if (block.general) {
        add_general(block);
      } else {
        add_mode(block);
      }
    }
  }

 private:
  void add_rigid(const Block& block) {
    const auto g = block.size();
    const auto p = block.left.rows();
    const auto q = block.right.cols();
    const auto count = g * (p + q);
    fit_.rigid_covariance =
        model_.scale * model_.scale * covariance_.block(first_, first_, count, count);
    for (Eigen::Index a = 0; a < g; ++a) {
      std::vector<Eigen::Index> own;
      for (Eigen::Index i = 0; i < p; ++i) own.push_back(i + p * a);
      for (Eigen::Index j = 0; j < q; ++j) own.push_back(g * p + a + g * j);
      Eigen::MatrixXd all = Eigen::MatrixXd::Zero(2 + p + q, 2 + p + q);
      all.bottomRightCorner(p + q, p + q) = fit_.rigid_covariance(own, own);
      if (fit_.complex) {
        Eigen::MatrixXd wider = Eigen::MatrixXd::Zero(2 + 2 * (p + q), 2 + 2 * (p + q));
        wider.topLeftCorner(2 + p + q, 2 + p + q) = all;
        put_complex(mode_, model_.scale * block.left.col(a), model_.scale * block.right.row(a),
                    wider);
      }
      put(0.0, 0.0, model_.scale * block.left.col(a), model_.scale * block.right.row(a), all);
    }
    first_ += count;
  }

  void add_general(const Block& block) {
    const auto count = parameter_count(block);
    const auto real = 2 + block.left.rows() + block.right.cols();
    const auto mode =
        general_mode_of(block, model_.scale, covariance_.block(first_, first_, count, count));
    put_complex(mode_, mode.outputs, mode.inputs, mode.covariance);
    put(mode.omega / (2.0 * std::numbers::pi), mode.damping_ratio, mode.outputs.real(),
        mode.inputs.real(), mode.covariance.topLeftCorner(real, real));
    first_ += count;
  }

  void add_mode(const Block& block) {
    const auto count = parameter_count(block);
    const Eigen::MatrixXd jacobian = physical(block, model_.scale);
    const double own = own_frequency(block);
    put(own * model_.scale / (2.0 * std::numbers::pi), block.damping(0, 0) / (2.0 * own),
        model_.scale * block.left.col(0), model_.scale * block.right.row(0),
        jacobian * covariance_.block(first_, first_, count, count) * jacobian.transpose());
    first_ += count;
  }

  void put_complex(Eigen::Index m, const Eigen::VectorXcd& outputs,
                   const Eigen::RowVectorXcd& inputs, const Eigen::MatrixXd& covariance) {
    auto& shapes = *fit_.complex;
    const auto p = outputs.size();
    const auto q = inputs.size();
    const Eigen::VectorXd deviation = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    shapes.outputs.col(m) = outputs;
    shapes.inputs.row(m) = inputs;
    shapes.output_real_std.col(m) = deviation.segment(2, p);
    shapes.input_real_std.row(m) = deviation.segment(2 + p, q).transpose();
    shapes.output_imaginary_std.col(m) = deviation.segment(2 + p + q, p);
    shapes.input_imaginary_std.row(m) = deviation.tail(q).transpose();
    shapes.covariance.push_back(covariance);
  }

  // In physical units.
  void put(double frequency_hz, double damping, const Eigen::VectorXd& left,
           const Eigen::RowVectorXd& right, const Eigen::MatrixXd& covariance) {
    const auto m = mode_++;
    const Eigen::VectorXd deviation = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    fit_.model.frequency_hz(m) = frequency_hz;
    fit_.model.damping_ratio(m) = damping;
    fit_.model.output_shapes.col(m) = left;
    fit_.model.input_shapes.row(m) = right;
    fit_.frequency_std_hz(m) = deviation(0) / (2.0 * std::numbers::pi);
    fit_.damping_std(m) = deviation(1);
    fit_.output_std.col(m) = deviation.segment(2, left.size());
    fit_.input_std.row(m) = deviation.tail(right.size()).transpose();
    fit_.mode_covariance.push_back(covariance);
  }

  const BlockModel& model_;
  const Eigen::MatrixXd& covariance_;
  ModalFit& fit_;
  Eigen::Index first_ = 0, mode_ = 0;
};

void resize(ModalFit& fit, const BlockModel& model, Eigen::Index outputs, Eigen::Index inputs) {
  Eigen::Index m = 0;
  for (const auto& block : model.blocks) {
    m += block.mode_count();
    if (block.rigid) fit.model.rigid_count = block.size();
  }
  fit.model.frequency_hz.resize(m);
  fit.model.damping_ratio.resize(m);
  fit.model.output_shapes.resize(outputs, m);
  fit.model.input_shapes.resize(m, inputs);
  fit.model.residual = model.residual;
  fit.frequency_std_hz.resize(m);
  fit.damping_std.resize(m);
  fit.output_std.resize(outputs, m);
  fit.input_std.resize(m, inputs);
  if (!fit.complex) return;
  auto& shapes = *fit.complex;
  shapes.outputs.resize(outputs, m);
  shapes.inputs.resize(m, inputs);
  shapes.output_real_std = shapes.output_imaginary_std = fit.output_std;
  shapes.input_real_std = shapes.input_imaginary_std = fit.input_std;
}

// Neighbours within a bandwidth form one group where the shape of either is hardly known: the data
// turn them into each other.
std::vector<modal::ModeGroup> groups_of(const ModalFit& fit) {
  const auto& model = fit.model;
  const auto unknown = [&](Eigen::Index m) {
    return fit.output_std.col(m).norm() > kUnknownShape * model.output_shapes.col(m).norm();
  };
  std::vector<modal::ModeGroup> groups;
  if (model.rigid_count > 0) groups.push_back({0, model.rigid_count});
  for (auto m = model.rigid_count; m < model.mode_count(); ++m) {
    const bool near = m > model.rigid_count &&
                      model.frequency_hz(m) - model.frequency_hz(m - 1) <
                          2.0 * std::max(model.damping_ratio(m), model.damping_ratio(m - 1)) *
                              model.frequency_hz(m);
    if (near && (unknown(m) || unknown(m - 1))) {
      ++groups.back().size;
    } else {
      groups.push_back({m, 1});
    }
  }
  return groups;
}

constexpr double kNothing = std::numeric_limits<double>::infinity();  // is known

// The delays with their deviations; the mean is that of the channels that were measured.
void fill_delays(const BlockModel& model, const Fitted& fitted, const Eigen::MatrixXd& covariance,
                 ModalFit& fit) {
  fit.delay_s = model.delay / model.scale;
  if (!fitted.delay) return;
  const auto n = fitted.delay_count(fit.model.output_count(), fit.model.input_count());
  const Eigen::MatrixXd own = covariance.bottomRightCorner(n, n) / (model.scale * model.scale);
  const Eigen::ArrayXd measured = (own.diagonal().array() > 0.0).cast<double>();
  const Eigen::VectorXd share = measured / std::max(1.0, measured.sum());
  fit.delay_std_s = std::sqrt(std::max(0.0, share.dot(own * share)));
  if (fitted.delay_of == DelayOf::all) return;
  fit.delay_of = fitted.delay_of;
  fit.channel_delay_s = model.channel_delay / model.scale;
  const double mean = share.dot(fit.channel_delay_s);
  fit.channel_delay_s.array() -= mean;
  fit.delay_s += mean;
  fit.channel_delay_std_s =
      (measured > 0.0).select(own.diagonal().array().max(0.0).sqrt(), kNothing);
}

void mark_unmeasured_output(Eigen::Index i, ComplexShapes& shapes) {
  const auto both = shapes.outputs.rows() + shapes.inputs.cols();
  shapes.output_real_std.row(i).setConstant(kNothing);
  shapes.output_imaginary_std.row(i).setConstant(kNothing);
  for (auto& covariance : shapes.covariance) {
    covariance(2 + i, 2 + i) = covariance(2 + both + i, 2 + both + i) = kNothing;
  }
}

void mark_unmeasured_input(Eigen::Index j, ComplexShapes& shapes) {
  const auto p = shapes.outputs.rows();
  const auto both = p + shapes.inputs.cols();
  shapes.input_real_std.col(j).setConstant(kNothing);
  shapes.input_imaginary_std.col(j).setConstant(kNothing);
  for (auto& covariance : shapes.covariance) {
    covariance(2 + p + j, 2 + p + j) = covariance(2 + both + p + j, 2 + both + p + j) = kNothing;
  }
}

}  // namespace

void mark_unmeasured(const Eigen::MatrixXd& weight, ModalFit& fit) {
  fit.residual_std = (weight.array() > 0.0).select(fit.residual_std, kNothing);
  const auto p = weight.rows();
  const auto g = fit.model.rigid_count;
  for (Eigen::Index i = 0; i < p; ++i) {
    if (weight.row(i).sum() > 0.0) continue;
    fit.output_std.row(i).setConstant(kNothing);
    for (auto& covariance : fit.mode_covariance) covariance(2 + i, 2 + i) = kNothing;
    for (Eigen::Index a = 0; a < g; ++a) fit.rigid_covariance(i + p * a, i + p * a) = kNothing;
    if (fit.complex) mark_unmeasured_output(i, *fit.complex);
  }
  for (Eigen::Index j = 0; j < weight.cols(); ++j) {
    if (weight.col(j).sum() > 0.0) continue;
    fit.input_std.col(j).setConstant(kNothing);
    for (auto& covariance : fit.mode_covariance) covariance(2 + p + j, 2 + p + j) = kNothing;
    for (Eigen::Index a = 0; a < g; ++a) {
      const auto at = g * p + a + g * j;
      fit.rigid_covariance(at, at) = kNothing;
    }
    if (fit.complex) mark_unmeasured_input(j, *fit.complex);
  }
}

ModalFit with_uncertainty(const Descent& found, const Target& target, const Fitted& fitted,
                          const FitData& data, Damping damping) {
  ModalFit fit;
  auto model = in_modes(found.model, fit.notes);
  const auto left_over = misfit(model, target, fitted);
  const auto normal = normal_equations(model, left_over, target, fitted);
  const auto parameters = parameter_count(model, fitted);
  const Eigen::MatrixXd idle = idle_directions(model, parameters);
  fit.cost = left_over.cost;
  fit.measured_count = data.measured_count();
  fit.parameter_count = parameters - idle.cols() +
                        (fitted.residual ? (data.weight.colwise().sum().array() > 0.0).count() : 0);
  fit.expected_cost = 0.5 * static_cast<double>(fit.measured_count - fit.parameter_count);
  fit.iterations = found.iterations;
  fit.converged = found.converged;
  const double variance = data.noise_known ? 1.0 : fit.cost / fit.expected_cost;
  const Eigen::MatrixXd covariance = 0.5 * variance * held_inverse(normal, idle);
  if (damping == Damping::general) fit.complex.emplace();
  resize(fit, model, data.outputs, data.inputs);
  Filler(model, covariance, fit).fill();
  const Eigen::VectorXd sums = target.squared.colwise().sum().transpose();
  const Eigen::VectorXd residual = (2.0 * sums.array().max(1e-300) / variance).sqrt().inverse();
  fit.residual_std = Eigen::Map<const Eigen::MatrixXd>(residual.data(), data.outputs, data.inputs);
  fill_delays(model, fitted, covariance, fit);
  fit.groups = groups_of(fit);
  mark_unmeasured(sums.reshaped(target.outputs, target.inputs), fit);
  if (!fitted.residual) fit.residual_std.setZero();
  return fit;
}

}  // namespace chladni::identification
