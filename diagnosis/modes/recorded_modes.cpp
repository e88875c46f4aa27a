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

// tᵀ A t of each column t.
VectorXd squares(const MatrixXd& a, const MatrixXd& columns) {
  if (a.isZero(0.0)) return VectorXd::Zero(columns.cols());
  return columns.cwiseProduct(MatrixXd(a * columns)).colwise().sum().transpose();
}

bool have_same_values(const auto& a, const auto& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() && a == b;
}

bool is_same_attachment(const Attached& a, const Attached& b) {
  return a.mass == b.mass && a.damping == b.damping && a.stiffness == b.stiffness &&
         a.carried == b.carried && have_same_values(a.shapes, b.shapes) &&
         have_same_values(a.upper, b.upper);
}

}  // namespace

bool have_same_body(const State& a, const State& b) {
  return have_same_values(a.stiffness, b.stiffness) && have_same_values(a.mass, b.mass) &&
         have_same_values(a.damping, b.damping) && have_same_values(a.loss, b.loss) &&
         have_same_values(a.dashpots, b.dashpots) &&
         have_same_values(a.kept_ratios, b.kept_ratios) &&
         std::ranges::equal(a.attached, b.attached, is_same_attachment);
}

ModeSolver::ModeSolver(State base, Index most)
    : base_(std::move(base)), most_(most), own_(own_ratios()), base_body_(solved(base_)) {}

ModeSolver::OwnRatios ModeSolver::own_ratios() const {
  const Index r = std::min(most_, base_.mode_count());
  OwnRatios own{base_.stiffness.diagonal().head(r).cwiseMax(0.0).cwiseSqrt(), {}};
  own.ratio = (own_damping(base_, r).diagonal() +
               base_.loss.diagonal().head(r).cwiseQuotient(own.omega.cwiseMax(1e-12)))
                  .cwiseQuotient(2.0 * own.omega.cwiseMax(1e-12));
  for (Index l = 0; l < r; ++l) {
    if (own.omega(l) < kConstants.no_stiffness * own.omega.maxCoeff()) own.ratio(l) = 0.0;
  }
  return own;
}

ModeSolver::OwnRatios::Factors ModeSolver::OwnRatios::factors(const VectorXd& motion,
                                                              double inertia, double to) const {
  double square = 0.0, kept = 0.0, viscous = 0.0, hysteretic = 0.0;
  for (Index l = 0; l < omega.size(); ++l) {
    if (!(ratio(l) > 0.0)) continue;  // a rigid-body motion
    const double part = motion(l) * motion(l);
    square += part;
    kept += ratio(l) * part;
    viscous += ratio(l) * omega(l) * part;
    hysteretic += ratio(l) * omega(l) * omega(l) * part;
  }
  if (!(viscous > 0.0)) return {};
  kept *= inertia / square;
  return {kept * to / viscous, kept * to * to / hysteretic};
}

ModeSolver::Body ModeSolver::solved(const State& state) const {
  Assembled all = assembled(state, most_);
  // The eigensolver does not look whether its own factor of the mass exists.
  if (Eigen::LLT<MatrixXd>(all.mass).info() != Eigen::Success) {
    throw NumericalFailure("a mass that is not positive");
  }
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(all.stiffness, all.mass);
  if (modes.info() != Eigen::Success || !modes.eigenvalues().allFinite()) {
    throw NumericalFailure("modes of a hypothesis: no eigenvalues");
  }
  return {modes.eigenvalues().cwiseMax(0.0), modes.eigenvectors(), std::move(all.damping),
          std::move(all.loss)};
}

// The body's own damping is that without what constants have added to keep their ratios, times
// factors that keep the ratios of its modes.
VectorXd ModeSolver::damping(const State& state, const Body& body,
                             const std::vector<Index>& columns) const {
  const MatrixXd turn = body.turn(Eigen::all, columns);
  const MatrixXd shapes = turn.topRows(std::min(most_, state.mode_count()));
  const VectorXd omega = body.lambda(columns).cwiseSqrt().cwiseMax(1e-12);
  const Index r = shapes.rows();
  MatrixXd bare = shapes;
  if (state.kept_ratios.size() > 0) {
    bare = state.kept_ratios.head(r).cwiseSqrt().cwiseInverse().asDiagonal() * shapes;
  }
  const MatrixXd own_viscous = own_damping(state, r);
  const MatrixXd own_loss = state.loss.topLeftCorner(r, r);
  const VectorXd viscous = squares(own_viscous, bare);
  const VectorXd loss = squares(own_loss, bare);
  const VectorXd inertia = squares(state.mass.topLeftCorner(r, r), shapes);
  VectorXd result = squares(body.damping, turn) - squares(own_viscous, shapes) +
                    (squares(body.loss, turn) - squares(own_loss, shapes)).cwiseQuotient(omega);
  for (Index k = 0; k < omega.size(); ++k) {
    const auto by = own_.factors(shapes.col(k), inertia(k), omega(k));
    result(k) += by.viscous * viscous(k) + by.loss * loss(k) / omega(k);
  }
  return result;
}

BodyModes ModeSolver::body_modes(const State& state, double low_hz, double high_hz) const {
  const bool is_base = have_same_body(state, base_);
  const Body other = is_base ? Body{} : solved(state);
  const Body& body = is_base ? base_body_ : other;
  const VectorXd omega = body.lambda.cwiseSqrt();
  std::vector<Index> columns;
  for (Index k = 0; k < omega.size(); ++k) {
    const double hz = omega(k) / (2.0 * std::numbers::pi);
    const bool is_flexible =
        body.lambda(k) > kConstants.no_stiffness * base_body_.lambda.maxCoeff();
    if (is_flexible && hz >= low_hz && hz <= high_hz) columns.push_back(k);
  }
  const VectorXd kept = omega(columns);
  return {kept / (2.0 * std::numbers::pi), damping(state, body, columns).cwiseQuotient(2.0 * kept),
          body.turn(Eigen::seqN(0, std::min(most_, state.mode_count())), columns)};
}

RecordedModes ModeSolver::modes(const State& state, double low_hz, double high_hz) const {
  return recorded(state, body_modes(state, low_hz, high_hz));
}

RecordedModes recorded(const State& state, const BodyModes& body) {
  RecordedModes result;
  result.frequency_hz = body.frequency_hz;
  result.damping_ratio = body.damping_ratio;
  result.motion = body.motion;
  result.output_of = state.output_of;
  result.input_of = state.input_of;
  const VectorXd omega = 2.0 * std::numbers::pi * body.frequency_hz;
  const Index r = body.motion.rows();
  record(state.output_paths, state.output_of, state.outputs.leftCols(r) * body.motion, omega,
         result.outputs, result.output_path);
  record(state.input_paths, state.input_of, state.inputs.topRows(r).transpose() * body.motion,
         omega, result.inputs, result.input_path);
  return result;
}

}  // namespace chladni::diagnosis
