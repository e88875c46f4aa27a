#include "diagnosis/modes/recorded_modes.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <complex>
#include <numbers>
#include <utility>
#include <vector>

#include "base/decompositions.h"
#include "base/error.h"
#include "base/index.h"
#include "diagnosis/constants.h"
#include "diagnosis/fit/responses.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// K, M and C of the first `most` coordinates, and one more coordinate for each carried mass.
struct Assembled {
  MatrixXd stiffness, mass, damping, loss;
};

// A spring, a dashpot and a mass between a displacement of the body and a coordinate of its own.
void add_carried(Assembled& to, const VectorXd& shape, double stiffness, double damping,
                 double mass) {
  const Index r = shape.size();
  const Index n = to.stiffness.rows();
  VectorXd stretch = VectorXd::Zero(n + 1);
  stretch.head(r) = shape;
  stretch(n) = -1.0;
  const auto grow = [n](MatrixXd& matrix) {
    matrix.conservativeResizeLike(MatrixXd::Zero(n + 1, n + 1));
  };
  for (auto* matrix : {&to.stiffness, &to.mass, &to.damping, &to.loss}) grow(*matrix);
  to.stiffness += stiffness * stretch * stretch.transpose();
  to.damping += damping * stretch * stretch.transpose();
  to.mass(n, n) += mass;
}

// The static flexibility of the modes above lies in series with an attachment. A positive mass is
// then carried on it. A spring becomes softer. What is negative hangs on the modes alone.
void add_attached(Assembled& to, const Attached& attached, Index most) {
  for (Index d = 0; d < attached.shapes.cols(); ++d) {
    const Index r = std::min(most, attached.shapes.rows());
    const VectorXd shape = attached.shapes.col(d).head(r);
    const double own = attached.upper.size() > 0 ? attached.upper.col(d).squaredNorm() : 0.0;
    const double spring = attached.stiffness / (1.0 + std::max(0.0, own * attached.stiffness));
    if (attached.carried) {
      add_carried(to, shape, spring, attached.damping, attached.mass);
      continue;
    }
    to.stiffness.topLeftCorner(r, r) += spring * shape * shape.transpose();
    to.damping.topLeftCorner(r, r) += attached.damping * shape * shape.transpose();
    if (own * attached.mass * to.stiffness.diagonal().head(r).maxCoeff() >
        1.0 / kConstants.far_above) {
      add_carried(to, shape, 1.0 / own, 0.0, attached.mass);
    } else {
      to.mass.topLeftCorner(r, r) += attached.mass * shape * shape.transpose();
    }
  }
}

Assembled assembled(const State& state, Index most) {
  const Index r = std::min(most, state.mode_count());
  Assembled all{state.stiffness.topLeftCorner(r, r), state.mass.topLeftCorner(r, r),
                state.damping.topLeftCorner(r, r), state.loss.topLeftCorner(r, r)};
  for (const auto& attached : state.attached) add_attached(all, attached, r);
  return all;
}

// Rows of the record: the shape of the channel that each one has, and the path at each mode.
void record(const std::vector<Path>& paths, const std::vector<Index>& channel_of,
            const MatrixXd& shapes, const VectorXd& omega, MatrixXd& rows,
            Eigen::MatrixXcd& path_at) {
  rows.resize(shapes.rows(), shapes.cols());
  path_at.resize(shapes.rows(), shapes.cols());
  for (Index i = 0; i < rows.rows(); ++i) rows.row(i) = shapes.row(channel_of[at(i)]);
  for (Index k = 0; k < omega.size(); ++k) {
    path_at.col(k) = factors(paths, std::complex<double>(0.0, omega(k)));
  }
}

// The first rows and columns of the body's own damping.
MatrixXd own_damping(const State& state, Index r) {
  MatrixXd own = state.damping.topLeftCorner(r, r);
  if (state.dashpots.size() > 0) own -= state.dashpots.topLeftCorner(r, r);
  return own;
}

// The body's own damping of a mode, where the modes keep the ratios that the study states.
struct OwnDamping {
  VectorXd omega, ratio;  // of the modes of the study's structure

  // Factors of the viscous and of the hysteretic damping that fixed matrices have in a mode of
  // circular frequency `to`. `motion` is its shape in the coordinates of the structure, and
  // `inertia` the part of its modal mass that is the body's.
  [[nodiscard]] std::pair<double, double> factors(const VectorXd& motion, double inertia,
                                                  double to) const {
    double squares = 0.0, kept = 0.0, viscous = 0.0, hysteretic = 0.0;
    for (Index l = 0; l < omega.size(); ++l) {
      if (!(ratio(l) > 0.0)) continue;  // a rigid-body motion
      const double square = motion(l) * motion(l);
      squares += square;
      kept += ratio(l) * square;
      viscous += ratio(l) * omega(l) * square;
      hysteretic += ratio(l) * omega(l) * omega(l) * square;
    }
    if (!(viscous > 0.0)) return {1.0, 1.0};
    kept *= inertia / squares;
    return {kept * to / viscous, kept * to * to / hysteretic};
  }
};

}  // namespace

ModeSolver::ModeSolver(State base, Index most)
    : base_(std::move(base)), most_(most), base_body_(solved(base_)) {}

bool ModeSolver::is_base(const State& state) const {
  return state.attached.empty() && base_.attached.empty() && state.stiffness == base_.stiffness &&
         state.mass == base_.mass && state.damping == base_.damping && state.loss == base_.loss;
}

ModeSolver::Body ModeSolver::solved(const State& state) const {
  const Assembled all = assembled(state, most_);
  // The eigensolver does not look whether its own factor of the mass exists.
  if (Eigen::LLT<MatrixXd>(all.mass).info() != Eigen::Success) {
    throw NumericalFailure("a mass that is not positive");
  }
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(all.stiffness, all.mass);
  if (modes.info() != Eigen::Success || !modes.eigenvalues().allFinite()) {
    throw NumericalFailure("modes of a hypothesis: no eigenvalues");
  }
  const MatrixXd& turn = modes.eigenvectors();
  const VectorXd lambda = modes.eigenvalues().cwiseMax(0.0);
  const VectorXd omega = lambda.cwiseSqrt().cwiseMax(1e-12);
  Body body;
  body.lambda = lambda;
  body.shapes = turn.topRows(std::min(most_, state.mode_count()));
  body.damping = (turn.transpose() * all.damping * turn).diagonal() +
                 (turn.transpose() * all.loss * turn).diagonal().cwiseQuotient(omega);
  keep_ratios(state, omega, body);
  return body;
}

void ModeSolver::keep_ratios(const State& state, const VectorXd& omega, Body& body) const {
  const Index r = body.shapes.rows();
  OwnDamping own{base_.stiffness.diagonal().head(r).cwiseMax(0.0).cwiseSqrt(), {}};
  own.ratio = (own_damping(base_, r).diagonal() +
               base_.loss.diagonal().head(r).cwiseQuotient(own.omega.cwiseMax(1e-12)))
                  .cwiseQuotient(2.0 * own.omega.cwiseMax(1e-12));
  for (Index l = 0; l < r; ++l) {
    if (own.omega(l) < kConstants.no_stiffness * own.omega.maxCoeff()) own.ratio(l) = 0.0;
  }
  // The body's own damping without what constants have added to keep their ratios.
  VectorXd root = VectorXd::Ones(r);
  if (state.kept_ratios.size() > 0) root = state.kept_ratios.head(r).cwiseSqrt().cwiseInverse();
  const MatrixXd own_viscous = own_damping(state, r);
  const MatrixXd viscous = root.asDiagonal() * own_viscous * root.asDiagonal();
  const MatrixXd loss = root.asDiagonal() * state.loss.topLeftCorner(r, r) * root.asDiagonal();
  for (Index k = 0; k < omega.size(); ++k) {
    const VectorXd t = body.shapes.col(k);
    const auto [viscous_by, loss_by] =
        own.factors(t, t.dot(state.mass.topLeftCorner(r, r) * t), omega(k));
    body.damping(k) +=
        viscous_by * t.dot(viscous * t) - t.dot(own_viscous * t) +
        (loss_by * t.dot(loss * t) - t.dot(state.loss.topLeftCorner(r, r) * t)) / omega(k);
  }
}

RecordedModes ModeSolver::modes(const State& state, double low_hz, double high_hz) const {
  const Body other = is_base(state) ? Body{} : solved(state);
  const Body& body = is_base(state) ? base_body_ : other;
  const VectorXd omega = body.lambda.cwiseSqrt();
  std::vector<Index> columns;
  for (Index k = 0; k < omega.size(); ++k) {
    const double hz = omega(k) / (2.0 * std::numbers::pi);
    const bool is_flexible =
        body.lambda(k) > kConstants.no_stiffness * base_body_.lambda.maxCoeff();
    if (is_flexible && hz >= low_hz && hz <= high_hz) columns.push_back(k);
  }
  RecordedModes result;
  const VectorXd kept = omega(columns);
  result.frequency_hz = kept / (2.0 * std::numbers::pi);
  result.damping_ratio = body.damping(columns).cwiseQuotient(2.0 * kept);
  result.motion = body.shapes(Eigen::all, columns);
  result.output_of = state.output_of;
  result.input_of = state.input_of;
  const MatrixXd& shapes = result.motion;
  record(state.output_paths, state.output_of, state.outputs.leftCols(shapes.rows()) * shapes, kept,
         result.outputs, result.output_path);
  record(state.input_paths, state.input_of,
         state.inputs.topRows(shapes.rows()).transpose() * shapes, kept, result.inputs,
         result.input_path);
  return result;
}

}  // namespace chladni::diagnosis
