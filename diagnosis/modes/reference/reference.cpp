#include "diagnosis/modes/reference/reference.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <utility>

#include "base/decompositions.h"
#include "base/error.h"
#include "base/index.h"
#include "base/upper_median.h"
#include "diagnosis/constants.h"
#include "diagnosis/modes/modes_fit.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;
using Complex = std::complex<double>;

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

// The modes of the reference that the structure has, with their frequencies and shapes there.
struct Anchors {
  std::vector<Index> reference;  // of each: the mode of the reference
  MatrixXd motion;               // r×a, orthonormal
  VectorXd omega;                // a [rad/s]
};

Anchors anchors_of(const ModesProblem& problem, const ModesFit& fit) {
  const auto& reference = problem.measured();
  Anchors anchors;
  std::vector<VectorXd> turned;
  std::vector<VectorXd> plain;
  for (Index i = 0; i < reference.count(); ++i) {
    const Index k = fit.matching.model[at(i)];
    if (k < 0) continue;
    const auto other = partner(reference, fit.model, problem.units(), i, fit.matching.span[at(i)]);
    anchors.reference.push_back(i);
    turned.emplace_back(fit.model.motion * other.parts);
    plain.emplace_back(fit.model.motion.col(k));
  }
  const auto count = static_cast<Index>(turned.size());
  anchors.motion.resize(problem.structure().mode_count(), count);
  anchors.omega.resize(count);
  for (Index a = 0; a < count; ++a) {
    anchors.motion.col(a) = turned[at(a)];
    anchors.omega(a) = 2.0 * std::numbers::pi * reference.frequency_hz(anchors.reference[at(a)]);
  }
  Eigen::SelfAdjointEigenSolver<MatrixXd> gram(
      MatrixXd(anchors.motion.transpose() * anchors.motion));
  if (count > 0 && gram.eigenvalues()(0) < kConstants.least_turned) {
    for (Index a = 0; a < count; ++a) anchors.motion.col(a) = plain[at(a)];
    gram.compute(MatrixXd(anchors.motion.transpose() * anchors.motion));
  }
  if (count > 0) anchors.motion *= gram.operatorInverseSqrt();
  return anchors;
}

// K − diag(ω²) for modes with the frequencies of the anchors.
MatrixXd correction_of(const Structure& structure, const ModesFit& fit, const Anchors& anchors) {
  const Index r = structure.mode_count();
  std::vector<double> ratio;
  for (Index a = 0; a < anchors.omega.size(); ++a) {
    const Index k = fit.matching.model[at(anchors.reference[at(a)])];
    ratio.push_back(anchors.omega(a) / (2.0 * std::numbers::pi * fit.model.frequency_hz(k)));
  }
  const VectorXd lambda = (2.0 * std::numbers::pi * structure.frequency_hz).cwiseAbs2();
  const MatrixXd& v = anchors.motion;
  const MatrixXd rest = MatrixXd::Identity(r, r) - v * v.transpose();
  MatrixXd corrected = v * anchors.omega.cwiseAbs2().asDiagonal() * v.transpose();
  corrected += std::pow(upper_median(ratio), 2) * rest * lambda.asDiagonal() * rest;
  corrected -= MatrixXd(lambda.asDiagonal());
  return 0.5 * (corrected + corrected.transpose());
}

double root_mean_square(const VectorXcd& values) {
  return values.norm() / std::sqrt(static_cast<double>(std::max<Index>(values.size(), 1)));
}

// Size of `a` over that of `b`, and the phase between them.
Complex ratio_of(const VectorXcd& a, const VectorXcd& b) {
  const double size = b.norm();
  return size > 0.0 ? std::polar(a.norm() / size, std::arg(b.dot(a))) : Complex(0.0, 0.0);
}

// One side of a later mode in the scale of the structure.
struct Side {
  std::vector<Index> rows;
  VectorXcd before, after;  // the reference in that scale; the later mode, of the same size
  VectorXd noise;
  Complex grown{1.0, 0.0};  // later over reference
};

// Size of a side's shapes in the structure, the phase between both. Channels that hardly see the
// mode have at least the size below which they count as blind.
Complex scale_of(const VectorXcd& before, const VectorXcd& model, double unit) {
  const double least =
      unit * std::sqrt(static_cast<double>(model.size())) * 2.0 / kConstants.blindest;
  const Complex ratio = ratio_of(before, model);
  const double size = before.norm() / std::max(model.norm(), least);
  return std::abs(ratio) > 0.0 ? ratio / std::abs(ratio) * size : Complex(size, 0.0);
}

Side side_of(const MatrixXcd& later, const MatrixXd& later_std, Index i, const MatrixXcd& reference,
             const MatrixXd& reference_std, Index j, const VectorXd& model, double unit) {
  Side side;
  side.rows = rows_of_both(later, i, reference, j);
  if (side.rows.empty()) return side;
  const VectorXcd before = reference(side.rows, j);
  const VectorXcd after = later(side.rows, i);
  const Complex scale = scale_of(before, model(side.rows).cast<Complex>(), unit);
  side.grown = ratio_of(after, before);
  if (!(std::abs(scale) > 0.0) || !(std::abs(side.grown) > 0.0)) return Side{};
  side.before = before / scale;
  // As real as it can be, with the sign of the model.
  Complex turn = std::conj(phase_of(side.before));
  if (turn.real() < 0.0) turn = -turn;
  side.before *= turn;
  side.after = after / (side.grown * scale) * turn;
  // The model's shapes are real: what is not so in both has not changed.
  side.after -= Complex(0.0, 1.0) * side.before.imag().cast<Complex>();
  const VectorXd own = later_std(side.rows, i) / std::abs(side.grown * scale);
  const VectorXd old = reference_std(side.rows, j) / std::abs(scale);
  const VectorXd change = (side.after - side.before.real().cast<Complex>()).cwiseAbs();
  const double mean = change.squaredNorm() / static_cast<double>(change.size());
  const double part = std::pow(kConstants.change_error, 2);
  side.noise =
      (own.array().square() + old.array().square() + part * (change.array().square() + mean))
          .sqrt();
  return side;
}

// Gives the channels the shapes that the reference has in mode a.
void record_as(ChannelSide& channels, const Side& side, const VectorXd& motion) {
  const VectorXd model = channels.shapes * motion;
  for (std::size_t a = 0; a < side.rows.size(); ++a) {
    const Index row = side.rows[a];
    const double off = side.before(static_cast<Index>(a)).real() - model(row);
    channels.shapes.row(row) += off * motion.transpose();
  }
}

void put(const Side& side, Index i, Complex scale, MatrixXcd& shapes, MatrixXd& deviation) {
  shapes.col(i).setConstant(Complex(kNotMeasured, kNotMeasured));
  deviation.col(i).setZero();
  for (std::size_t a = 0; a < side.rows.size(); ++a) {
    const auto at_row = static_cast<Index>(a);
    shapes(side.rows[a], i) = side.after(at_row) * scale;
    deviation(side.rows[a], i) = side.noise(at_row) * std::abs(scale);
  }
}

// The deviations of a model's mode besides those of the measurement.
void widen(MeasuredModes& modes, Index i, const PerClass& levels) {
  const auto level = [&](ErrorClass of) { return levels(static_cast<Index>(of)); };
  modes.frequency_std(i) = std::hypot(modes.frequency_std(i), level(ErrorClass::frequency));
  modes.damping_std(i) = std::hypot(modes.damping_std(i), level(ErrorClass::damping));
  const double off = std::hypot(level(ErrorClass::shape), level(ErrorClass::smooth_shape));
  const auto wider = [&](const MatrixXcd& shapes, MatrixXd& deviation) {
    const auto rows = rows_with_values(shapes, i);
    const double size = root_mean_square(shapes(rows, i));
    for (const Index row : rows) deviation(row, i) = std::hypot(deviation(row, i), off * size);
  };
  wider(modes.output_shapes, modes.output_std);
  wider(modes.input_shapes, modes.input_std);
}

// Later mode i beside its anchor.
void refer(Referred& result, Index i, const ModesProblem& problem, const Anchors& anchors,
           Index a) {
  auto& later = result.measured;
  const auto& reference = problem.measured();
  const auto& original = problem.structure();
  const Index j = anchors.reference[at(a)];
  const VectorXd motion = anchors.motion.col(a);
  const double moved = std::log(later.frequency_hz(i) / reference.frequency_hz(j));
  later.frequency_std(i) = std::hypot(later.frequency_std(i), reference.frequency_std(j),
                                      kConstants.change_error * moved);
  later.damping_std(i) = std::hypot(later.damping_std(i), reference.damping_std(j));
  if (!(reference.damping_ratio(j) > 0.0)) later.damping_ratio(i) = kNotMeasured;
  const auto out =
      side_of(later.output_shapes, later.output_std, i, reference.output_shapes,
              reference.output_std, j, original.outputs.shapes * motion, problem.units().outputs);
  const auto in =
      side_of(later.input_shapes, later.input_std, i, reference.input_shapes, reference.input_std,
              j, original.inputs.shapes * motion, problem.units().inputs);
  record_as(result.structure.outputs, out, motion);
  record_as(result.structure.inputs, in, motion);
  put(out, i, out.grown * in.grown, later.output_shapes, later.output_std);
  put(in, i, 1.0, later.input_shapes, later.input_std);
}

// Damping ratios of the structure's modes that are anchors.
void damp(Structure& structure, const ModesFit& fit, const Anchors& anchors,
          const MeasuredModes& reference) {
  for (Index a = 0; a < anchors.omega.size(); ++a) {
    const Index j = anchors.reference[at(a)];
    const Index k = fit.matching.model[at(j)];
    if (!(reference.damping_ratio(j) > 0.0) || !(fit.model.damping_ratio(k) > 0.0)) continue;
    Index coordinate = 0;
    fit.model.motion.col(k).cwiseAbs().maxCoeff(&coordinate);
    const double stiffer = reference.frequency_hz(j) / fit.model.frequency_hz(k);
    structure.damping_ratio(coordinate) *=
        stiffer * reference.damping_ratio(j) / fit.model.damping_ratio(k);
  }
}

// The corrected structure has the reference's damping ratios but for modes that turned: the later
// ratios follow.
void keep_damping(Referred& result, const Anchors& anchors, const MeasuredModes& reference,
                  const std::vector<Index>& earlier) {
  const State state = state_of(result.structure);
  const auto modes = ModeSolver(state, state.mode_count())
                         .modes(state, 0.0, std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < earlier.size(); ++i) {
    const auto anchor = std::ranges::find(anchors.reference, earlier[i]);
    if (anchor == anchors.reference.end() || !(reference.damping_ratio(earlier[i]) > 0.0)) continue;
    Index k = 0;
    const VectorXd motion = anchors.motion.col(anchor - anchors.reference.begin());
    (modes.motion.transpose() * motion).cwiseAbs().maxCoeff(&k);
    result.measured.damping_ratio(static_cast<Index>(i)) *=
        modes.damping_ratio(k) / reference.damping_ratio(earlier[i]);
  }
}

// All later modes; those that stay.
std::vector<Index> refer_all(Referred& result, const ModesProblem& problem, const ModesFit& fit,
                             const Anchors& anchors, const std::vector<Index>& earlier) {
  std::vector<Index> kept;
  for (Index i = 0; i < result.measured.count(); ++i) {
    const Index j = earlier[at(i)];
    const auto anchor = std::ranges::find(anchors.reference, j);
    const double hz = result.measured.frequency_hz(i);
    if (j >= 0 && anchor == anchors.reference.end()) {
      result.notes.push_back(fmt::format(
          "the mode at {:.6g} Hz was measured before and after, and the study has none: left out",
          hz));
      continue;
    }
    kept.push_back(i);
    if (j < 0) {
      widen(result.measured, i, fit.levels);
      result.notes.push_back(fmt::format(
          "the mode at {:.6g} Hz is not in the reference: it counts with the errors of the model",
          hz));
      continue;
    }
    result.reference_hz(i) = problem.measured().frequency_hz(j);
    refer(result, i, problem, anchors, anchor - anchors.reference.begin());
  }
  return kept;
}

void note_lost(Referred& result, const MeasuredModes& reference,
               const std::vector<Index>& earlier) {
  for (Index j = 0; j < reference.count(); ++j) {
    if (std::ranges::find(earlier, j) != earlier.end()) continue;
    result.notes.push_back(
        fmt::format("the mode of the reference at {:.6g} Hz was not measured later",
                    reference.frequency_hz(j)));
  }
}

}  // namespace

Referred referred(const Structure& structure, const MeasuredModes& later,
                  const MeasuredModes& reference, const Tolerances& tolerances) {
  const ModesProblem problem(structure, reference, tolerances, true);
  const ModesFit fit = problem.nothing();
  const Anchors anchors = anchors_of(problem, fit);
  require(!anchors.reference.empty(),
          "no mode of the study is among those of the reference: frequencies or shapes differ");
  Referred result{structure, later, VectorXd::Constant(later.count(), kNotMeasured), {}};
  result.measured.scaled = later.scaled && reference.scaled;
  result.structure.correction = correction_of(structure, fit, anchors);
  damp(result.structure, fit, anchors, reference);
  const auto earlier = earlier_modes(later, reference);
  const auto kept = refer_all(result, problem, fit, anchors, earlier);
  note_lost(result, reference, earlier);
  require(!kept.empty(), "no mode of the study is among those before and after");
  keep_damping(result, anchors, reference, earlier);
  result.measured = part(result.measured, kept);
  result.reference_hz = VectorXd(result.reference_hz(kept));
  return result;
}

Tolerances repeatable(const Tolerances& tolerances) {
  Tolerances result = tolerances;
  result.modulus = std::min(tolerances.modulus, kConstants.repeated_modulus);
  result.density = result.thickness = result.orthotropy = result.mass = 0.0;
  return result;
}

LevelPrior repeatability(const Tolerances& tolerances, bool learned) {
  const double shape = kConstants.repeated_shape;
  LevelPrior prior;
  prior.usual << kConstants.repeated_frequency, kConstants.repeated_damping, shape, shape, shape,
      std::min(tolerances.gain, kConstants.repeated_gain),
      std::min(tolerances.position, kConstants.repeated_place), 1e-6, shape;
  const auto ordinary = level_prior(tolerances, true);
  const auto phase = static_cast<Index>(ErrorClass::phase);
  prior.usual(phase) = kConstants.repeated_phase;
  prior.usual = prior.usual.max(1e-6);
  prior.at_most = kConstants.repeated_at_most * prior.usual;
  prior.at_most(phase) = ordinary.at_most(phase);
  if (learned) prior.width = kConstants.repeated_width;
  return prior;
}

}  // namespace chladni::diagnosis
