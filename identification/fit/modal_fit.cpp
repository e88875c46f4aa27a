#include "identification/modal_fit.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/finite.h"
#include "identification/constants.h"
#include "identification/likelihood/block_fractions.h"
#include "identification/likelihood/levenberg.h"
#include "identification/likelihood/uncertainty/fit_uncertainty.h"
#include "identification/poles/completion.h"
#include "identification/poles/residue_problem.h"

namespace chladni::identification {
namespace {

using Complex = std::complex<double>;

void check(const FitData& data, const Start& start, const FitOptions& options) {
  require(data.value.rows() == data.line_count() && data.weight.rows() == data.line_count() &&
              data.value.cols() == data.outputs * data.inputs &&
              data.weight.cols() == data.value.cols() && data.outputs > 0 && data.inputs > 0,
          "modal fit: values, weights and channels do not fit together");
  require(
      start.residue.empty() || static_cast<Eigen::Index>(start.residue.size()) == start.pole.size(),
      "modal fit: " + fmt::to_string(start.residue.size()) + " residues for " +
          fmt::to_string(start.pole.size()) + " poles");
  require(start.pole.size() + start.rigid_count > 0, "modal fit: a start without modes");
  require(start.rigid_count <= std::min(data.outputs, data.inputs),
          "modal fit: " + fmt::to_string(start.rigid_count) +
              " rigid-body modes cannot be told "
              "apart by " +
              fmt::to_string(data.outputs) + " outputs and " + fmt::to_string(data.inputs) +
              " inputs");
  require(start.rigid_count <= Constants::most_rigid,
          "modal fit: " + fmt::to_string(start.rigid_count) +
              " rigid-body modes, expected 12 or fewer");
  const auto channels = data.outputs + data.inputs;
  const auto of_mode = parameters_of_mode(data, options.damping);
  const auto parameters =
      start.pole.size() * of_mode + start.rigid_count * (channels - start.rigid_count) +
      (options.residual ? (data.weight.colwise().sum().array() > 0.0).count() : 0) +
      Fitted{false, options.delay, options.delay_of}.delay_count(data.outputs, data.inputs);
  require(data.measured_count() > parameters,
          "modal fit: " + fmt::to_string(data.measured_count()) + " measured numbers for " +
              fmt::to_string(parameters) + " parameters");
  for (const auto& pole : start.pole) {
    require(pole.real() < 0.0 && pole.imag() > 0.0,
            "modal fit: a start pole is not damped or not oscillating");
  }
}

// Groups of poles closer than a half-power bandwidth, in order; at most Constants::largest_block in
// a group.
std::vector<std::vector<Eigen::Index>> neighbours(const Eigen::VectorXcd& poles) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(poles.size()));
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<Eigen::Index>(i);
  std::sort(order.begin(), order.end(),
            [&](auto a, auto b) { return poles(a).imag() < poles(b).imag(); });
  std::vector<std::vector<Eigen::Index>> all;
  for (const auto i : order) {
    const bool near = !all.empty() &&
                      static_cast<Eigen::Index>(all.back().size()) < Constants::largest_block &&
                      std::abs(poles(i).imag() - poles(all.back().back()).imag()) <
                          2.0 * std::max(-poles(i).real(), -poles(all.back().back()).real());
    if (near) {
      all.back().push_back(i);
    } else {
      all.push_back({i});
    }
  }
  return all;
}

// Σ |w h|² for each response: the cost that a unit residue at the pole adds.
Eigen::MatrixXd weighted_squares(Complex pole, const Target& target) {
  Eigen::VectorXd square(target.line_count());
  for (Eigen::Index k = 0; k < square.size(); ++k) {
    const Complex s(0.0, target.x(k));
    square(k) = 1.0 / std::norm(s * s - 2.0 * pole.real() * s + std::norm(pole));
  }
  const Eigen::VectorXd sum = target.squared.transpose() * square;
  return Eigen::Map<const Eigen::MatrixXd>(sum.data(), target.outputs, target.inputs);
}

// u sqrt(σ) and sqrt(σ) vᵀ of the largest singular values.
struct Sides {
  Eigen::MatrixXd left, right;
  Eigen::VectorXd sigma;
};

Sides sides(const Eigen::MatrixXd& residue, const MeasuredResponses& measured, Eigen::Index count) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(
      finite(completed(residue, measured, count), "residue"),
      Eigen::ComputeThinU | Eigen::ComputeThinV);
  const auto size = std::min(count, svd.singularValues().size());
  const Eigen::VectorXd root = svd.singularValues().head(size).cwiseSqrt();
  return {svd.matrixU().leftCols(size) * root.asDiagonal(),
          root.asDiagonal() * svd.matrixV().leftCols(size).transpose(),
          svd.singularValues().head(size)};
}

// Whether every direction of a group stands out of the noise.
bool all_stand_out(const Sides& group, Complex pole, const Target& target) {
  const Eigen::MatrixXd square = weighted_squares(pole, target);
  const double least = Constants::least_worth * static_cast<double>(target.outputs + target.inputs);
  for (Eigen::Index r = 0; r < group.sigma.size(); ++r) {
    const Eigen::MatrixXd part = group.left.col(r) * group.right.row(r);
    if (part.cwiseAbs2().cwiseProduct(square).sum() < least) return false;
  }
  return true;
}

// Makes one block of a group of poles; its directions are the singular vectors of the sum of their
// residues. If these directions are fewer than the poles, each pole becomes a mode of its own.
std::vector<Block> blocks_of(const std::vector<Complex>& poles,
                             const std::vector<Eigen::MatrixXd>& residues, const Target& target,
                             const MeasuredResponses& measured) {
  const auto size = static_cast<Eigen::Index>(poles.size());
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(target.outputs, target.inputs);
  for (const auto& residue : residues) sum += residue;
  const auto group = sides(sum, measured, size);
  if (size > 1 && (group.sigma.size() < size || !all_stand_out(group, poles.front(), target))) {
    std::vector<Block> single;
    for (std::size_t r = 0; r < poles.size(); ++r) {
      const auto own = sides(residues[r], measured, 1);
      single.push_back(single_mode(poles[r], own.left.col(0), own.right.row(0)));
    }
    return single;
  }
  Eigen::VectorXd stiffness(size);
  Eigen::VectorXd damping(size);
  for (Eigen::Index r = 0; r < size; ++r) {
    const Complex pole = poles[static_cast<std::size_t>(r)];
    stiffness(r) = std::norm(pole);
    damping(r) = -2.0 * pole.real();
  }
  return {{.left = group.left,
           .right = group.right,
           .stiffness = stiffness.asDiagonal(),
           .damping = damping.asDiagonal()}};
}

Block rigid_block(const Eigen::MatrixXd& residue, const MeasuredResponses& measured,
                  Eigen::Index count) {
  const auto all = sides(residue, measured, count);
  return {.left = all.left,
          .right = all.right,
          .stiffness = Eigen::MatrixXd::Zero(count, count),
          .damping = Eigen::MatrixXd::Zero(count, count),
          .rigid = true};
}

// Residues of a start in units of the model. `general` holds X of X/(s − p), or is empty.
struct StartResidues {
  std::vector<Eigen::MatrixXd> real;
  std::vector<Eigen::MatrixXcd> general;
  Eigen::MatrixXd rigid;
};

StartResidues start_residues(const FitData& data, const Start& start, Damping damping,
                             double scale) {
  const bool rigid = start.rigid_count > 0;
  if (damping == Damping::general && !start.general.empty()) {
    StartResidues given{{}, start.general, start.rigid / (scale * scale)};
    for (auto& residue : given.general) residue /= scale;
    return given;
  }
  auto fitted = ResidueProblem(data, start.pole, rigid).residues();
  StartResidues result{start.residue.empty() ? fitted.of_pole : start.residue, {}, fitted.rigid};
  if (damping == Damping::general) {
    if (start.residue.empty()) {
      fitted = ResidueProblem(data, start.pole, rigid, Damping::general).residues();
      result.general = std::move(fitted.general);
      result.rigid = fitted.rigid;
    } else {
      for (std::size_t m = 0; m < result.real.size(); ++m) {
        const Complex twice(0.0, 2.0 * start.pole(static_cast<Eigen::Index>(m)).imag());
        result.general.emplace_back(result.real[m].cast<Complex>() / twice);
      }
    }
  }
  for (auto& residue : result.real) residue /= scale * scale;
  for (auto& residue : result.general) residue /= scale;
  result.rigid /= scale * scale;
  return result;
}

// Makes a complex mode of the largest singular direction of X.
Block strongest_mode(Complex pole, const Eigen::MatrixXcd& residue,
                     const MeasuredResponses& measured) {
  const Eigen::JacobiSVD<Eigen::MatrixXcd> svd(finite(completed(residue, measured, 1), "residue"),
                                               Eigen::ComputeThinU | Eigen::ComputeThinV);
  return general_mode(pole, svd.singularValues()(0) * svd.matrixU().col(0),
                      svd.matrixV().col(0).adjoint());
}

BlockModel start_model(const FitData& data, const Start& start, const Target& target, double scale,
                       Damping damping) {
  BlockModel model{.scale = scale, .blocks = {}, .residual = {}, .channel_delay = {}};
  model.residual =
      start.constant.size() > 0 ? start.constant : Eigen::MatrixXd::Zero(data.outputs, data.inputs);
  const auto residues = start_residues(data, start, damping, scale);
  const auto measured = measured_responses(target.squared, target.outputs);
  if (start.rigid_count > 0) {
    model.blocks.push_back(rigid_block(residues.rigid, measured, start.rigid_count));
  }
  for (const auto& group : neighbours(start.pole)) {
    if (damping == Damping::general && (group.size() == 1 || !start.general.empty())) {
      for (const auto i : group) {
        model.blocks.push_back(strongest_mode(
            start.pole(i) / scale, residues.general[static_cast<std::size_t>(i)], measured));
      }
      continue;
    }
    std::vector<Complex> poles;
    std::vector<Eigen::MatrixXd> parts;
    for (const auto i : group) {
      poles.push_back(start.pole(i) / scale);
      parts.emplace_back(residues.real[static_cast<std::size_t>(i)]);
    }
    for (auto& block : blocks_of(poles, parts, target, measured))
      model.blocks.push_back(std::move(block));
  }
  return model;
}

// Writes every block as complex modes and continues the descent from there.
Descent with_complex_modes(const Descent& in_blocks, const Target& target, const Fitted& fitted,
                           const DescentOptions& options) {
  BlockModel general = in_blocks.model;
  general.blocks.clear();
  bool any = false;
  const auto add = [&](const std::vector<Block>& modes) {
    general.blocks.insert(general.blocks.end(), modes.begin(), modes.end());
  };
  for (const auto& block : in_blocks.model.blocks) {
    if (block.rigid || block.general) {
      general.blocks.push_back(block);
      continue;
    }
    any = true;
    const auto modes = general_modes(block);
    if (!modes.empty()) {
      add(modes);
      continue;
    }
    for (const auto& mode : forced_modes(block)) add(general_modes(mode));
  }
  if (!any) return in_blocks;
  auto result = descent(std::move(general), target, fitted, options);
  result.iterations += in_blocks.iterations;
  return result;
}

// Writes every block as single modes if that does not raise the cost.
Descent with_single_modes(const Descent& in_blocks, const Target& target, const Fitted& fitted,
                          const DescentOptions& options) {
  BlockModel single = in_blocks.model;
  single.blocks.clear();
  bool any = false;
  for (const auto& block : in_blocks.model.blocks) {
    const auto modes =
        block.rigid || block.size() == 1 ? std::vector<Block>{} : diagonalised(block);
    if (modes.empty()) {
      single.blocks.push_back(block);
    } else {
      single.blocks.insert(single.blocks.end(), modes.begin(), modes.end());
      any = true;
    }
  }
  if (!any) return in_blocks;
  auto result = descent(std::move(single), target, fitted,
                        {.iterations = Constants::single_iterations,
                         .damping = 1e-8,
                         .keep_best = options.keep_best,
                         .progress = options.progress});
  const double allowed =
      in_blocks.misfit.cost * (1.0 + Constants::single_modes_cost) + 1e-24 * target.total;
  result.iterations += in_blocks.iterations;
  // If the data hardly separate the modes of a block, the descent is long and leads nowhere else.
  if (result.misfit.cost <
      in_blocks.misfit.cost + Constants::same_cost * target.noise_level(in_blocks.misfit.cost)) {
    result.converged = in_blocks.converged;
  }
  return result.misfit.cost <= allowed ? result : in_blocks;
}

// The channels of each part by their numbers: "y1 y2 from u1; y3 from u2", the first three parts.
std::string part_names(const std::vector<ConnectedChannels>& parts) {
  constexpr std::size_t kMostNamed = 3;
  const auto joined = [](const std::vector<Eigen::Index>& channels, const char* letter) {
    std::string text;
    for (const auto c : channels) text += fmt::format(" {}{}", letter, c + 1);
    return text;
  };
  std::string text;
  for (std::size_t n = 0; n < std::min(parts.size(), kMostNamed); ++n) {
    text += (n == 0 ? "" : ";") + joined(parts[n].outputs, "y") + " from" +
            joined(parts[n].inputs, "u");
  }
  return text.substr(1) + (parts.size() > kMostNamed ? "; ..." : "");
}

// Notes that nothing connects the shapes of some channels with those of others: no response between
// them tells whether a mode of the one is a mode of the other, nor by which factor and sign.
void note_parts(const MeasuredResponses& measured, ModalFit& fit) {
  const auto parts = connected_channels(measured);
  if (parts.size() < 2) return;
  fit.notes.push_back(
      "the channels are " + fmt::to_string(parts.size()) +
      " parts without a response between them (" + part_names(parts) +
      "): a mode that several parts see is mostly found, and counts, once in each. How its shape "
      "goes on from one part to another is not known, nor are the responses between the parts: its "
      "deviations are finite only in the part that sees it best, and what shapes and models have "
      "elsewhere, zeros mostly, says nothing. Measure one response between the parts, or identify "
      "them one by one");
}

}  // namespace

FitOptions first_fit_options(FitOptions options) {
  options.iterations = std::min(options.iterations, Constants::first_iterations);
  return options;
}

Eigen::Index parameters_of_mode(const FitData& data, Damping damping) {
  const auto channels = data.outputs + data.inputs;
  return damping == Damping::general ? 2 * channels : channels + 1;
}

double noise_level(const ModalFit& fit, const FitData& data) {
  return noise_level(data, fit.cost, fit.parameter_count);
}

Start start_at(const modal::ReducedModel& model) {
  Start start;
  start.rigid_count = model.rigid_count;
  start.pole.resize(model.mode_count() - model.rigid_count);
  for (Eigen::Index m = 0; m < start.pole.size(); ++m) {
    const double own = 2.0 * std::numbers::pi * model.frequency_hz(start.rigid_count + m);
    const double ratio = model.damping_ratio(start.rigid_count + m);
    start.pole(m) = own * Complex(-ratio, std::sqrt(std::max(1e-12, 1.0 - ratio * ratio)));
  }
  return start;
}

Start start_of(const ModalFit& fit) {
  Start start = start_at(fit.model);
  if (!fit.complex) return start;
  const auto rigid = fit.model.rigid_count;
  for (Eigen::Index m = 0; m < start.pole.size(); ++m) {
    const Complex twice(0.0, 2.0 * start.pole(m).imag());
    start.general.emplace_back(fit.complex->outputs.col(rigid + m) *
                               fit.complex->inputs.row(rigid + m) / twice);
  }
  start.rigid = fit.model.output_shapes.leftCols(rigid) * fit.model.input_shapes.topRows(rigid);
  start.constant = fit.model.residual;
  return start;
}

ModalFit modal_fit(const FitData& data, const Start& start, const FitOptions& options) {
  check(data, start, options);
  const double scale = 2.0 * std::numbers::pi * data.frequency_hz(data.line_count() - 1);
  const auto aim = target(data, scale);
  const Fitted fitted{options.residual, options.delay, options.delay_of};
  const DescentOptions how{.iterations = options.iterations,
                           .keep_best = options.keep_best,
                           .progress = options.progress};
  auto from = start_model(data, start, aim, scale, options.damping);
  if (options.delay && options.delay_of != DelayOf::all) {
    from.channel_delay.setZero(fitted.delay_count(data.outputs, data.inputs));
  }
  auto best = descent(std::move(from), aim, fitted, how);
  if (!std::isfinite(best.misfit.cost)) {
    throw NumericalFailure("modal fit: the cost at the start is not finite");
  }
  best = options.damping == Damping::general ? with_complex_modes(best, aim, fitted, how)
                                             : with_single_modes(best, aim, fitted, how);
  auto fit = with_uncertainty(best, aim, fitted, data, options.damping);
  note_parts(measured_responses(data.weight, data.outputs), fit);
  return fit;
}

}  // namespace chladni::identification
