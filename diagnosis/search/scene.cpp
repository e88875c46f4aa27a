#include "diagnosis/search/scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "diagnosis/attached/attachments.h"
#include "diagnosis/constants.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Complex = std::complex<double>;

double chi_square(const Observed& observed, const MatrixXcd& model) {
  return ((observed.value - model).cwiseAbs().array() * observed.weight.array()).square().sum();
}

// Highest values that are not near a higher one, the largest first.
std::vector<Index> peaks_of(const Surface& surface, const Eigen::VectorXd& explained) {
  std::vector<Index> order(static_cast<std::size_t>(explained.size()));
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<Index>(i);
  std::ranges::stable_sort(order, [&](Index a, Index b) { return explained(a) > explained(b); });
  const auto& places = surface.places;
  const double apart = Surface::kOnePeak * surface.size();
  std::vector<Index> peaks;
  for (const auto i : order) {
    const bool near = std::ranges::any_of(
        peaks, [&](Index j) { return (places.row(i) - places.row(j)).norm() < apart; });
    if (!near) peaks.push_back(i);
    if (peaks.size() == kConstants.peaks) break;
  }
  return peaks;
}

}  // namespace

PlaceScan place_scan(const Structure& structure, const Observed& observed, const Solved& now,
                     const State& state) {
  const Index places = structure.surface.count();
  PlaceScan scan;
  scan.explained = Eigen::VectorXd::Zero(places);
  if (places == 0) return scan;
  const Index p = state.output_count();
  const Index q = state.input_count();
  const MatrixXd& shapes = structure.surface.shapes;  // n×r
  constexpr Index kBlock = 16;                        // lines at once
  MatrixXcd to_outputs, from_inputs;                  // of a block, n rows
  for (Index k = 0; k < observed.line_count(); ++k) {
    const Index in_block = k % kBlock;
    if (in_block == 0) {
      const Index lines = std::min(kBlock, observed.line_count() - k);
      to_outputs = product(shapes, now.left_columns.middleCols(p * k, p * lines));
      from_inputs = product(shapes, now.right_columns.middleCols(q * k, q * lines));
    }
    const Complex s(0.0, observed.omega(k));
    const MatrixXcd to =
        factors(state.output_paths, s).asDiagonal() *
        to_outputs.middleCols(p * in_block, p).transpose()(state.output_of, Eigen::all);
    const MatrixXcd from =
        factors(state.input_paths, s).asDiagonal() *
        from_inputs.middleCols(q * in_block, q).transpose()(state.input_of, Eigen::all);
    const MatrixXcd error = (observed.value.row(k) - now.value.row(k)).reshaped(p, q);
    const MatrixXd w2 = observed.weight.row(k).array().square().matrix().reshaped(p, q);
    const MatrixXcd weighted = error.cwiseProduct(w2.cast<Complex>());
    const MatrixXcd toward = weighted.adjoint() * to;  // q×n: Σ_i conj(w² e_ij) to_i
    const MatrixXd to2 = to.cwiseAbs2();
    const MatrixXd from2 = from.cwiseAbs2();
    const MatrixXd power = w2.transpose() * to2;  // q×n
    for (Index n = 0; n < places; ++n) {
      const Complex b = (toward.col(n).array() * from.col(n).array()).sum();
      const double a = power.col(n).dot(from2.col(n));
      if (a > 0.0) scan.explained(n) += std::norm(b) / a;
    }
  }
  scan.peaks = peaks_of(structure.surface, scan.explained);
  return scan;
}

Scene::Scene(const Structure& structure, const Observed& observed, State state,
             const MatrixXd& widening)
    : structure_(structure),
      observed_(widened(observed, widening)),
      state_(std::move(state)),
      body_(state_, observed_.omega, false),
      now_(solved(state_, body_)),
      misfit_(chi_square(observed_, now_.value)),
      places_(place_scan(structure_, observed_, now_, state_)) {
  const Eigen::VectorXd damping =
      structure.damping_ratio.tail(structure.mode_count() - structure.rigid_count);
  frequency_step_ =
      std::clamp(damping.mean(), kConstants.least_frequency_step, kConstants.most_frequency_step);
}

double Scene::low_hz() const { return observed_.omega(0) / (2.0 * std::numbers::pi); }
double Scene::high_hz() const {
  return observed_.omega(observed_.line_count() - 1) / (2.0 * std::numbers::pi);
}

Solved Scene::solved_at(const State& state) const {
  if (body_.same(state)) return solved(state, body_);
  return solved(state, Body(state, observed_.omega, false));
}

// Adds one more output and input at the place.
Scene::Touched Scene::touched(const Attached& attached) const {
  const Index p = state_.output_count();
  const Index q = state_.input_count();
  const Index above = state_.output_upper.cols();
  State probe = state_;
  const auto with_row = [](MatrixXd& matrix, const Eigen::VectorXd& row) {
    matrix.conservativeResize(matrix.rows() + 1, row.size());
    matrix.bottomRows(1) = row.transpose();
  };
  const Eigen::VectorXd shape = attached.shapes.col(0);
  const Eigen::VectorXd upper = attached.upper.rows() == above && above > 0
                                    ? Eigen::VectorXd(attached.upper.col(0))
                                    : Eigen::VectorXd::Zero(above);
  with_row(probe.outputs, shape);
  with_row(probe.output_upper, upper);
  with_row(probe.input_upper, upper);
  probe.inputs.conservativeResize(Eigen::NoChange, q + 1);
  probe.inputs.col(q) = shape;
  probe.residual = probe.output_upper * probe.input_upper.transpose();
  probe.output_paths.resize(static_cast<std::size_t>(p + 1));
  probe.input_paths.resize(static_cast<std::size_t>(q + 1));
  probe.output_of.push_back(p);
  probe.input_of.push_back(q);
  probe.frames.clear();
  probe.stiffening.resize(0);
  const Solved seen = solved(probe, body_);
  Touched touch;
  touch.shape = shape;
  touch.to.resize(p, observed_.line_count());
  touch.from.resize(q, observed_.line_count());
  touch.own.resize(observed_.line_count());
  for (Index k = 0; k < observed_.line_count(); ++k) {
    const MatrixXcd structure = seen.structure.row(k).reshaped(p + 1, q + 1);
    touch.to.col(k) = structure.col(q).head(p);
    touch.from.col(k) = structure.row(p).head(q).transpose();
    touch.own(k) = structure(p, q);
  }
  return touch;
}

// True if only channels, paths, the residual, one more frame or one more attachment differ.
bool Scene::near(const State& changed) const {
  const std::size_t more = changed.attached.size() - state_.attached.size();
  const bool drifts_alike = changed.stiffening.size() == state_.stiffening.size() &&
                            changed.stiffening == state_.stiffening;
  return body_.same(changed) && drifts_alike && more <= 1;
}

bool Scene::is_cheap(const Supposed& cause) const {
  State changed = state_;
  cause.effect->apply(changed, structure_, cause.option, cause.x);
  return near(changed);
}

// A mass counts along the normal only, the first of its displacements: the fit takes them all.
double Scene::quick_misfit(const State& changed, Touched& touch) const {
  const Attached* more =
      changed.attached.size() > state_.attached.size() ? &changed.attached.back() : nullptr;
  if (more != nullptr && (touch.shape.size() == 0 || touch.shape != more->shapes.col(0))) {
    touch = touched(*more);
  }
  const bool channels_move = changed.outputs != state_.outputs || changed.inputs != state_.inputs;
  const MatrixXcd outputs = (changed.outputs - state_.outputs).cast<Complex>();
  const MatrixXcd inputs = (changed.inputs - state_.inputs).cast<Complex>();
  MatrixXcd more_residual;
  if (changed.residual != state_.residual) {
    more_residual = (changed.residual - state_.residual).cast<Complex>();
  }
  const Index p = state_.output_count();
  double sum = 0.0;
  for (Index k = 0; k < observed_.line_count(); ++k) {
    const Complex s(0.0, observed_.omega(k));
    MatrixXcd structure = now_.structure.row(k).reshaped(p, state_.input_count());
    if (channels_move) {
      // To first order in both sides: no effect on an unchanged body moves an output and an input.
      structure += outputs * now_.right(k);
      structure += now_.left(k) * inputs;
    }
    if (more_residual.size() > 0) structure += more_residual;
    if (changed.frames.size() != state_.frames.size()) {
      structure += frame_responses(changed, s) - frame_responses(state_, s);
    }
    if (more != nullptr) {
      const Complex z = dynamic_stiffness(*more, s);
      structure -=
          (z / (1.0 + z * touch.own(k))) * (touch.to.col(k) * touch.from.col(k).transpose());
    }
    const MatrixXcd value = recorded(changed, structure, s);
    sum += ((observed_.value.row(k).reshaped(p, state_.input_count()) - value).cwiseAbs2().array() *
            observed_.weight.row(k).reshaped(p, state_.input_count()).array().square())
               .sum();
  }
  return sum;
}

Eigen::VectorXd Scene::misfits(const Effect& effect, const std::vector<EffectStart>& starts) const {
  Eigen::VectorXd all(static_cast<Index>(starts.size()));
  Touched touch;
  for (std::size_t n = 0; n < starts.size(); ++n) {
    State changed = state_;
    effect.apply(changed, structure_, starts[n].option, starts[n].x);
    double& misfit = all(static_cast<Index>(n));
    try {
      misfit = near(changed) ? quick_misfit(changed, touch)
                             : chi_square(observed_, responses(changed, observed_.omega, false));
    } catch (const NumericalFailure&) {
      misfit = HUGE_VAL;  // such a structure is impossible
    }
  }
  return all;
}

double Scene::factor(Index first, Index stride, Index count) const {
  double along = 0.0;
  double power = 0.0;
  for (Index n = 0; n < count; ++n) {
    const Index c = first + stride * n;
    const auto w2 = observed_.weight.col(c).array().square();
    along += (w2 * (now_.value.col(c).conjugate().array() * observed_.value.col(c).array()).real())
                 .sum();
    power += (w2 * now_.value.col(c).array().abs2()).sum();
  }
  return power > 0.0 ? along / power : 1.0;
}

double Scene::row_factor(Index output) const {
  return factor(output, state_.output_count(), state_.input_count());
}

double Scene::column_factor(Index input) const {
  return factor(state_.output_count() * input, 1, state_.output_count());
}

Scene::Gain Scene::gain(const MatrixXcd& change) const {
  const Eigen::ArrayXXd w2 = observed_.weight.array().square();
  const double along =
      (w2 * (change.conjugate().array() * (observed_.value - now_.value).array()).real()).sum();
  const double power = (w2 * change.array().abs2()).sum();
  if (power <= 0.0) return {};
  return {along * along / power, along / power};
}

}  // namespace chladni::diagnosis
