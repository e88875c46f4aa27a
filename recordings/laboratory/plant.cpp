#include "recordings/laboratory/plant.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <unsupported/Eigen/MatrixFunctions>

#include "base/error.h"
#include "base/turn.h"
#include "modal/state_space.h"

namespace chladni::recordings {
namespace {

// States q and q̇ of one mode.
Plant::Block mode_block(const modal::ReducedModel& model, Eigen::Index mode,
                        const std::vector<modal::FrfKind>& kinds) {
  const double omega = kTwoPi * model.frequency_hz(mode);
  const double damping = 2.0 * model.damping_ratio(mode) * omega;
  Plant::Block block{Eigen::MatrixXd(2, 2), Eigen::MatrixXd::Zero(2, model.input_count()),
                     Eigen::MatrixXd::Zero(model.output_count(), 2)};
  block.a << 0.0, 1.0, -omega * omega, -damping;
  block.b.row(1) = model.input_shapes.row(mode);
  for (Eigen::Index i = 0; i < model.output_count(); ++i) {
    const double shape = model.output_shapes(i, mode);
    switch (kinds[static_cast<std::size_t>(i)]) {
      case modal::FrfKind::receptance:
        block.c(i, 0) = shape;
        break;
      case modal::FrfKind::mobility:
        block.c(i, 1) = shape;
        break;
      case modal::FrfKind::accelerance:
        block.c.row(i) = shape * block.a.row(1);
        break;
    }
  }
  return block;
}

// What the static flexibility and the modes pass on at once; nothing if all are displacements.
std::optional<RatePath> rate_path(const modal::ReducedModel& model,
                                  const std::vector<modal::FrfKind>& kinds) {
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(model.output_count(), model.input_count());
  RatePath result{.force = none, .rate = none, .second = none, .is_displacement = {}};
  bool any = false;
  for (Eigen::Index i = 0; i < model.output_count(); ++i) {
    const auto kind = kinds[static_cast<std::size_t>(i)];
    result.is_displacement.push_back(kind == modal::FrfKind::receptance);
    if (result.is_displacement.back()) continue;
    any = true;
    const bool velocity = kind == modal::FrfKind::mobility;
    if (!velocity) result.force.row(i) = model.output_shapes.row(i) * model.input_shapes;
    (velocity ? result.rate : result.second).row(i) = model.residual.row(i);
  }
  if (!any) return std::nullopt;
  return result;
}

// The dashpots on the modes alone. Residual flexibility in series with a dashpot c is a state that
// follows within c R, some 1e-7 s: it moves no line that is measured, but forces would reach
// accelerations through it at once and be taken back at once.
modal::ReducedModel without_series_flexibility(modal::ReducedModel model) {
  model.dampers.to_outputs.setZero();
  model.dampers.from_inputs.setZero();
  model.dampers.among.setZero();
  return model;
}

// All states of a model whose dashpots couple the modes.
Plant coupled(const modal::ReducedModel& model, const std::vector<modal::FrfKind>& kinds) {
  const auto rates = rate_path(model, kinds);
  const auto used = rates ? without_series_flexibility(model) : model;
  const auto receptance = modal::state_space(used);
  Plant result{
      .blocks = {{receptance.a, receptance.b, receptance.c}}, .d = receptance.d, .rates = rates};
  for (const auto kind : {modal::FrfKind::mobility, modal::FrfKind::accelerance}) {
    const auto other = modal::state_space(used, kind);
    for (Eigen::Index i = 0; i < model.output_count(); ++i) {
      if (kinds[static_cast<std::size_t>(i)] != kind) continue;
      result.blocks.front().c.row(i) = other.c.row(i);
      result.d.row(i).setZero();
    }
  }
  return result;
}

// A pole above the real axis gives a block with its real and imaginary part; a real pole one state.
Plant::Block pole_block(std::complex<double> pole, const Eigen::RowVectorXcd& in,
                        const Eigen::VectorXcd& out) {
  if (pole.imag() == 0.0) {
    return {Eigen::MatrixXd::Constant(1, 1, pole.real()), in.real(), out.real()};
  }
  Plant::Block block{Eigen::MatrixXd(2, 2), Eigen::MatrixXd(2, in.size()),
                     Eigen::MatrixXd(out.size(), 2)};
  block.a << pole.real(), -pole.imag(), pole.imag(), pole.real();
  block.b << in.real(), in.imag();
  block.c << 2.0 * out.real(), -2.0 * out.imag();
  return block;
}

}  // namespace

modal::ReducedModel at_rest_above(const modal::ReducedModel& model, double high_hz) {
  modal::check(model);
  const Eigen::Index kept = (model.frequency_hz.array() <= high_hz).count();
  const Eigen::Index above = model.mode_count() - kept;
  const Eigen::VectorXd yields =
      (kTwoPi * model.frequency_hz.tail(above)).cwiseAbs2().cwiseInverse();
  const Eigen::MatrixXd outputs = model.output_shapes.rightCols(above) * yields.asDiagonal();
  const Eigen::MatrixXd inputs = model.input_shapes.bottomRows(above);
  const Eigen::MatrixXd dampers = model.dampers.shapes.rightCols(above);
  modal::ReducedModel result = model;
  result.frequency_hz.conservativeResize(kept);
  result.damping_ratio.conservativeResize(kept);
  result.output_shapes = model.output_shapes.leftCols(kept);
  result.input_shapes = model.input_shapes.topRows(kept);
  result.residual += outputs * inputs;
  result.dampers.shapes = model.dampers.shapes.leftCols(kept);
  if (model.damper_count() == 0) return result;
  result.dampers.to_outputs += outputs * dampers.transpose();
  result.dampers.from_inputs += dampers * yields.asDiagonal() * inputs;
  result.dampers.among += dampers * yields.asDiagonal() * dampers.transpose();
  return result;
}

Plant plant(const modal::ReducedModel& model, const std::vector<modal::FrfKind>& kinds) {
  modal::check(model);
  auto each = kinds;
  if (each.empty()) {
    each.assign(static_cast<std::size_t>(model.output_count()), modal::FrfKind::receptance);
  }
  require(static_cast<Eigen::Index>(each.size()) == model.output_count(),
          "plant: " + fmt::to_string(each.size()) + " kinds for " +
              fmt::to_string(model.output_count()) + " outputs");
  if (model.damper_count() > 0) return coupled(model, each);
  Plant result;
  result.d.setZero(model.output_count(), model.input_count());
  for (Eigen::Index k = 0; k < model.mode_count(); ++k) {
    result.blocks.push_back(mode_block(model, k, each));
  }
  for (Eigen::Index i = 0; i < model.output_count(); ++i) {
    const bool displacement = each[static_cast<std::size_t>(i)] == modal::FrfKind::receptance;
    if (displacement) result.d.row(i) = model.residual.row(i);
  }
  result.rates = rate_path(model, each);
  return result;
}

Plant plant(const ChainMatrices& chain, const Eigen::VectorXd& sensors_m,
            const Eigen::VectorXd& actuators_m, double highest_hz) {
  require(chain.sway_stiffness > 0.0, "rigid chain: without flexures it has no separate poles");
  const auto n = chain.mass.rows();
  const Eigen::MatrixXd sensors = displacement_rows(chain, sensors_m);
  const Eigen::MatrixXd forces = displacement_rows(chain, actuators_m).transpose();
  // Modal coordinates come first: they scale the first-order matrix well.
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(chain.stiffness,
                                                                        chain.mass);
  const Eigen::MatrixXd& shapes = modes.eigenvectors();
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  const Eigen::VectorXd omega = modes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  a.topRightCorner(n, n) = omega.asDiagonal();
  a.bottomLeftCorner(n, n) = -omega.asDiagonal().toDenseMatrix();
  a.bottomRightCorner(n, n) = -shapes.transpose() * chain.damping * shapes;
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(a);
  if (solver.info() != Eigen::Success) throw NumericalFailure("rigid chain: no poles");
  const Eigen::MatrixXcd right = solver.eigenvectors();
  Eigen::MatrixXd b = Eigen::MatrixXd::Zero(2 * n, forces.cols());
  b.bottomRows(n) = shapes.transpose() * forces;
  const Eigen::MatrixXcd in = right.partialPivLu().solve(b.cast<std::complex<double>>());
  const Eigen::MatrixXcd out =
      sensors * shapes * omega.cwiseInverse().asDiagonal() * right.topRows(n);
  Plant result;
  result.d.setZero(sensors.rows(), forces.cols());
  for (Eigen::Index k = 0; k < 2 * n; ++k) {
    const auto pole = solver.eigenvalues()(k);
    if (pole.imag() < 0.0) continue;
    auto block = pole_block(pole, in.row(k), out.col(k));
    if (std::abs(pole) <= kTwoPi * highest_hz) {
      result.blocks.push_back(std::move(block));
    } else {
      result.d -= block.c * block.a.partialPivLu().solve(block.b);
    }
  }
  return result;
}

std::vector<SampledBlock> sampled(const Plant& plant, double sample_time_s, double late_fraction) {
  require(std::isfinite(sample_time_s) && sample_time_s > 0.0,
          "plant: the sample time is not positive");
  require(late_fraction >= 0.0 && late_fraction < 1.0,
          "plant: a fraction of " + fmt::format("{:.6g}", late_fraction) + "; expected 0 to 1");
  const auto held = [](const Plant::Block& block, double time) {
    const auto s = block.a.rows();
    const auto q = block.b.cols();
    Eigen::MatrixXd both = Eigen::MatrixXd::Zero(s + q, s + q);
    both.topLeftCorner(s, s) = time * block.a;
    both.topRightCorner(s, q) = time * block.b;
    return Eigen::MatrixXd(both.exp());
  };
  std::vector<SampledBlock> result;
  for (const auto& block : plant.blocks) {
    const auto s = block.a.rows();
    const Eigen::MatrixXd whole = held(block, sample_time_s);
    SampledBlock one{whole.topLeftCorner(s, s), whole.topRightCorner(s, block.b.cols()),
                     Eigen::MatrixXd::Zero(s, block.b.cols()), block.c};
    if (late_fraction > 0.0) {
      one.b = held(block, (1.0 - late_fraction) * sample_time_s).topRightCorner(s, block.b.cols());
      one.b_late = whole.topRightCorner(s, block.b.cols()) - one.b;
    }
    result.push_back(std::move(one));
  }
  return result;
}

SampledDelay sampled_delay(double delay_s, double sample_time_s) {
  const double samples = delay_s / sample_time_s;
  require(samples >= 0.0 && samples <= 1e4,
          "a delay of " + fmt::format("{:.6g}", delay_s) + " s; expected 0 to 10000 samples");
  SampledDelay result;
  result.whole = static_cast<Eigen::Index>(std::floor(samples + 1e-9));
  result.fraction = std::max(0.0, samples - static_cast<double>(result.whole));
  const double f = result.fraction;
  if (f <= 0.5) {
    result.weight = {0.5 - f, 0.5 + f, 0.0};
  } else {
    result.weight = {0.0, 1.5 - f, f - 0.5};
  }
  return result;
}

}  // namespace chladni::recordings
