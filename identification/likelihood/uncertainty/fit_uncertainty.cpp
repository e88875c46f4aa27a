#include "identification/likelihood/uncertainty/fit_uncertainty.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/text_stream.h"
#include "identification/constants.h"
#include "identification/likelihood/general_mode.h"
#include "identification/likelihood/uncertainty/covariance.h"
#include "identification/likelihood/uncertainty/untold.h"

namespace chladni::identification {
namespace {

double own_frequency(const Block& block) {
  if (block.general) return std::abs(block.pole);
  return block.rigid ? 0.0 : std::sqrt(block.stiffness(0, 0));
}

// Single modes in order of frequency, with signs fixed (in each part, where there are several). A
// note tells each block that is split.
BlockModel in_modes(const BlockModel& model, const Parts& parts, std::vector<std::string>& notes) {
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
    TextWriter text;
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
    if (parts.size() > 1) block = balanced_in_parts(block, parts);
  }
  return result;
}

// Sets infinite variances where `unknown`.
void mark(const Unknown& unknown, Eigen::MatrixXd& covariance) {
  for (Eigen::Index i = 0; i < unknown.size(); ++i) {
    if (unknown(i)) covariance(i, i) = std::numeric_limits<double>::infinity();
  }
}

// Jacobian of (ω, ζ, L, R) of a single mode by its parameters (L, R, K, D), in physical units.
Eigen::MatrixXd real_mode_jacobian(const Block& block, double scale) {
  const auto pq = block.left.rows() + block.right.cols();
  const double own = own_frequency(block);
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(2 + pq, pq + 2);
  jacobian(0, pq) = scale / (2.0 * own);
  jacobian(1, pq) = -block.damping(0, 0) / (4.0 * own * own * own);
  jacobian(1, pq + 1) = 1.0 / (2.0 * own);
  jacobian.bottomLeftCorner(pq, pq) = scale * Eigen::MatrixXd::Identity(pq, pq);
  return jacobian;
}

// Unknown entries of (ω, ζ, Re L, Re R, Im L, Im R): those that depend on an unknown parameter of a
// general block (left, right, σ, ω).
Unknown unknown_of_general(const Unknown& parameters, const Block& block) {
  const auto p = block.left.rows();
  const auto q = block.right.cols();
  Unknown rows = Unknown::Constant(2 + 2 * (p + q), false);
  rows(0) = parameters(2 * (p + q) + 1);
  rows(1) = rows(0) || parameters(2 * (p + q));
  for (Eigen::Index i = 0; i < p; ++i) {
    rows(2 + i) = rows(2 + p + q + i) = parameters(i) || parameters(p + i);
  }
  for (Eigen::Index j = 0; j < q; ++j) {
    rows(2 + p + j) = rows(2 + 2 * p + q + j) =
        parameters(2 * (p + j)) || parameters(2 * (p + j) + 1);
  }
  return rows;
}

class Filler {
 public:
  // @param weight  p×q: Σ w² of each response
  Filler(const BlockModel& model, const Covariance& covariance, const Parts& parts,
         const Eigen::MatrixXd& weight, ModalFit& fit)
      : model_(model), covariance_(covariance), parts_(parts), weight_(weight), fit_(fit) {}

  void fill() {
    for (const auto& block : model_.blocks) {
      if (parts_.size() > 1) {
        home_.insert(home_.end(), static_cast<std::size_t>(block.mode_count()),
                     home_part(block, weight_, parts_));
      }
      if (block.rigid) {
        add_rigid(block);
      } else if (block.general) {
        add_general(block);
      } else {
        add_mode(block);
      }
    }
  }

  // The part that sees each mode best; empty where all channels are connected.
  [[nodiscard]] const std::vector<std::size_t>& home() const { return home_; }

 private:
  void add_rigid(const Block& block) {
    const auto g = block.size();
    const auto p = block.left.rows();
    const auto q = block.right.cols();
    const auto count = g * (p + q);
    fit_.rigid_covariance =
        model_.scale * model_.scale * covariance_.matrix.block(first_, first_, count, count);
    mark(covariance_.unknown.segment(first_, count), fit_.rigid_covariance);
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
    const Eigen::MatrixXd own = covariance_.matrix.block(first_, first_, count, count);
    auto mode = general_mode_of(block, model_.scale, own);
    if (parts_.size() > 1) {  // the rules between both sides hold in the home alone
      const Block at_home = block_at(block, parts_[home_.back()]);
      mode.covariance = general_mode_of(at_home, model_.scale, own).covariance;
    }
    mark(unknown_of_general(covariance_.unknown.segment(first_, count), block), mode.covariance);
    put_complex(mode_, mode.outputs, mode.inputs, mode.covariance);
    put(mode.omega / (2.0 * std::numbers::pi), mode.damping_ratio, mode.outputs.real(),
        mode.inputs.real(), mode.covariance.topLeftCorner(real, real));
    const double held = covariance_.held_variance(first_ + count - 2);
    put_held_damping(held / std::norm(block.pole));
    first_ += count;
  }

  void add_mode(const Block& block) {
    const auto count = parameter_count(block);
    const Eigen::MatrixXd jacobian = real_mode_jacobian(block, model_.scale);
    const double own = own_frequency(block);
    Eigen::MatrixXd covariance =
        jacobian * covariance_.matrix.block(first_, first_, count, count) * jacobian.transpose();
    const Eigen::VectorXd unknown = covariance_.unknown.segment(first_, count).cast<double>();
    mark((jacobian.cwiseAbs() * unknown).array() > 0.0, covariance);
    put(own * model_.scale / (2.0 * std::numbers::pi), block.damping(0, 0) / (2.0 * own),
        model_.scale * block.left.col(0), model_.scale * block.right.row(0), covariance);
    put_held_damping(covariance_.held_variance(first_ + count - 1) / (4.0 * own * own));
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

  // All arguments are in physical units.
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

  // The variance of the last mode's damping, where a bound holds it. Its deviation stays unknown.
  void put_held_damping(double variance) {
    if (!(variance > 0.0)) return;
    fit_.mode_covariance.back()(1, 1) = variance;
    if (fit_.complex) fit_.complex->covariance.back()(1, 1) = variance;
  }

  const BlockModel& model_;
  const Covariance& covariance_;
  const Parts& parts_;
  const Eigen::MatrixXd& weight_;
  ModalFit& fit_;
  std::vector<std::size_t> home_;
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

// The outputs at which mode m is seen: those with a measured response of which it is a part. Where
// no response connects parts of the channels, a mode is mostly seen in one of them.
std::vector<Eigen::Index> outputs_that_see(const Eigen::MatrixXd& weight, const ModalFit& fit,
                                           Eigen::Index m) {
  constexpr double kUnseen = 1e-9;  // of the largest residue
  const Eigen::MatrixXd residue = (fit.model.output_shapes.col(m) * fit.model.input_shapes.row(m))
                                      .cwiseAbs()
                                      .cwiseProduct((weight.array() > 0.0).cast<double>().matrix());
  const Eigen::VectorXd size = residue.rowwise().maxCoeff();
  std::vector<Eigen::Index> seen;
  for (Eigen::Index i = 0; i < size.size(); ++i) {
    if (size(i) > kUnseen * size.maxCoeff()) seen.push_back(i);
  }
  return seen;
}

bool has_common(const std::vector<Eigen::Index>& a, const std::vector<Eigen::Index>& b) {
  return std::ranges::any_of(a, [&](auto i) { return std::ranges::find(b, i) != b.end(); });
}

// Neighbours within a bandwidth form one group if the shape of either is hardly known at the
// outputs that see it: the data do not separate them. Modes that no output sees both are apart.
std::vector<modal::ModeGroup> groups_of(const Eigen::MatrixXd& weight, const ModalFit& fit) {
  const auto& model = fit.model;
  const auto unknown = [&](Eigen::Index m, const std::vector<Eigen::Index>& seen) {
    return fit.output_std.col(m)(seen).norm() >
           Constants::unknown_shape * model.output_shapes.col(m)(seen).norm();
  };
  std::vector<modal::ModeGroup> groups;
  if (model.rigid_count > 0) groups.push_back({0, model.rigid_count});
  std::vector<Eigen::Index> before;
  for (auto m = model.rigid_count; m < model.mode_count(); ++m) {
    const auto seen = outputs_that_see(weight, fit, m);
    const bool near = m > model.rigid_count && has_common(seen, before) &&
                      model.frequency_hz(m) - model.frequency_hz(m - 1) <
                          2.0 * std::max(model.damping_ratio(m), model.damping_ratio(m - 1)) *
                              model.frequency_hz(m);
    if (near && (unknown(m, seen) || unknown(m - 1, before))) {
      ++groups.back().size;
    } else {
      groups.push_back({m, 1});
    }
    before = seen;
  }
  return groups;
}

constexpr double kNothing = std::numeric_limits<double>::infinity();  // deviation if unknown

// Notes the modes whose damping is held by its bound.
void note_undamped(const BlockModel& model, ModalFit& fit) {
  for (const auto& block : model.blocks) {
    if (!is_undamped(block)) continue;
    TextWriter text;
    text << "mode at " << own_frequency(block) * model.scale / (2.0 * std::numbers::pi)
         << " Hz: the data ask for no damping; it is held at a ratio of " << kLeastDampingRatio
         << ", its deviation is not known";
    fit.notes.push_back(text.str());
  }
}

// The delays with their deviations. The mean is over the measured channels.
void fill_delays(const BlockModel& model, const Fitted& fitted, const Covariance& covariance,
                 ModalFit& fit) {
  fit.delay_s = model.delay / model.scale;
  if (!fitted.delay) return;
  const auto n = fitted.delay_count(fit.model.output_count(), fit.model.input_count());
  const Eigen::MatrixXd own =
      covariance.matrix.bottomRightCorner(n, n) / (model.scale * model.scale);
  const Eigen::ArrayXd measured = (!covariance.unknown.tail(n)).cast<double>();
  const Eigen::VectorXd share = measured / std::max(1.0, measured.sum());
  fit.delay_std_s =
      measured.sum() > 0.0 ? std::sqrt(std::max(0.0, share.dot(own * share))) : kNothing;
  if (fitted.delay_of == DelayOf::all) return;
  fit.delay_of = fitted.delay_of;
  fit.channel_delay_s = model.channel_delay / model.scale;
  const double mean = share.dot(fit.channel_delay_s);
  fit.channel_delay_s.array() -= mean;
  fit.delay_s += mean;
  fit.channel_delay_std_s =
      (measured > 0.0).select(own.diagonal().array().max(0.0).sqrt(), kNothing);
}

}  // namespace

ModalFit with_uncertainty(const Descent& found, const Target& target, const Fitted& fitted,
                          const FitData& data, Damping damping) {
  ModalFit fit;
  const auto parts = connected_channels(measured_responses(data.weight, data.outputs));
  auto model = in_modes(found.model, parts, fit.notes);
  const auto left_over = misfit(model, target, fitted);
  const auto normal = normal_equations(model, left_over, target, fitted);
  const auto parameters = parameter_count(model, fitted);
  const Eigen::MatrixXd idle = idle_directions(model, parameters, parts);
  fit.cost = left_over.cost;
  fit.measured_count = data.measured_count();
  fit.parameter_count = parameters - idle.cols() +
                        (fitted.residual ? (data.weight.colwise().sum().array() > 0.0).count() : 0);
  const auto expected = expected_cost(data, fit.parameter_count);
  fit.expected_cost = expected.mean;
  fit.cost_deviation = expected.deviation;
  fit.iterations = found.iterations;
  fit.converged = found.converged;
  const double variance = noise_level(fit, data) * variance_factor(data);
  auto covariance = held_inverse(model, normal, idle);
  covariance.matrix *= 0.5 * variance;
  covariance.held_variance *= 0.5 * variance;
  if (damping == Damping::general) fit.complex.emplace();
  resize(fit, model, data.outputs, data.inputs);
  const Eigen::MatrixXd sums =
      target.squared.colwise().sum().reshaped(target.outputs, target.inputs);
  Filler filler(model, covariance, parts, sums, fit);
  filler.fill();
  note_undamped(model, fit);
  fit.residual_std = (2.0 * sums.array().max(1e-300) / variance).sqrt().inverse();
  fill_delays(model, fitted, covariance, fit);
  fit.groups = groups_of(sums, fit);
  mark_other_parts(parts, filler.home(), fit);
  mark_unmeasured(sums, fit);
  if (!fitted.residual) fit.residual_std.setZero();
  return fit;
}

}  // namespace chladni::identification
