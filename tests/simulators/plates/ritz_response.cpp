#include "simulators/plates/ritz_response.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "host/parallel.h"
#include "simulators/plates/gauss_rule.h"

namespace chladni::simulators {
namespace {

using Eigen::Index;
using std::numbers::pi;
using Complex = std::complex<double>;

// The matrices of a stage on the plate's modal coordinates, then the resonators, then the frame.
struct Assembled {
  Eigen::MatrixXd mass, stiffness, viscous, loss;
  Eigen::MatrixXd dampers;  // N×d, each scaled by the root of its constant
  Eigen::MatrixXd outputs;  // p×N
  Eigen::MatrixXd inputs;   // N×q
  bool attached = false;    // mass and stiffness are not diagonal
};

void check(const RitzStage& stage) {
  const Index n = stage.plate.mode_count();
  require(stage.damping.viscous.rows() == n && stage.damping.viscous.cols() == n,
          "damping that does not fit the plate's modes");
  for (const auto& point : stage.points) {
    require(point.mass >= 0.0 && point.rotary_inertia >= 0.0 && point.stiffness >= 0.0 &&
                point.damping >= 0.0,
            "an attachment of less than 0");
  }
  for (const auto& one : stage.resonators) {
    require(one.mass > 0.0 && one.frequency_hz > 0.0 && one.damping_ratio >= 0.0,
            "a resonator needs a mass and a frequency");
  }
  require(!stage.frame || (stage.frame->mass > 0.0 && stage.frame->frequency_hz > 0.0),
          "a frame needs a mass and a frequency");
}

Eigen::VectorXd extended(const Eigen::RowVectorXd& row, Index size) {
  Eigen::VectorXd column = Eigen::VectorXd::Zero(size);
  column.head(row.size()) = row.transpose();
  return column;
}

void append_damper(Assembled& all, const Eigen::VectorXd& shape, double constant) {
  if (constant == 0.0) return;
  all.dampers.conservativeResize(all.mass.rows(), all.dampers.cols() + 1);
  all.dampers.rightCols(1) = std::sqrt(constant) * shape;
}

void add_outer(Eigen::MatrixXd& matrix, const Eigen::VectorXd& shape, double factor) {
  if (factor != 0.0) matrix += factor * shape * shape.transpose();
}

void add_point(Assembled& all, const RitzModes& plate, const RitzPoint& point) {
  const auto rows = modal_rows(plate, point.place.transpose());
  const Index size = all.mass.rows();
  const auto shape = extended(rows.deflection, size);
  add_outer(all.mass, shape, point.mass);
  add_outer(all.mass, extended(rows.slope_x, size), point.rotary_inertia);
  add_outer(all.mass, extended(rows.slope_y, size), point.rotary_inertia);
  add_outer(all.stiffness, shape, point.stiffness);
  append_damper(all, shape, point.damping);
}

void add_resonator(Assembled& all, const RitzModes& plate, const RitzResonator& one, Index dof) {
  const double omega = 2.0 * pi * one.frequency_hz;
  Eigen::VectorXd stretch =
      -extended(modal_rows(plate, one.place.transpose()).deflection, all.mass.rows());
  stretch(dof) = 1.0;
  all.mass(dof, dof) = one.mass;
  add_outer(all.stiffness, stretch, one.mass * omega * omega);
  append_damper(all, stretch, 2.0 * one.damping_ratio * one.mass * omega);
}

void add_pad(Assembled& all, const RitzModes& plate, const RitzPad& pad) {
  const Eigen::Vector2d half(0.5 * plate.body.length, 0.5 * plate.body.width);
  const auto rule = disc_rule(pad.centre, pad.radius, half, plate.body.degree + 2);
  const Eigen::MatrixXd rows = modal_rows(plate, rule.places).deflection;
  const Index n = rows.cols();
  all.stiffness.topLeftCorner(n, n) +=
      pad.stiffness / rule.area.sum() * (rows.transpose() * rule.area.asDiagonal() * rows);
}

void add_frame(Assembled& all, const RitzFrame& frame, Index dof) {
  const double omega = 2.0 * pi * frame.frequency_hz;
  Eigen::VectorXd shape = Eigen::VectorXd::Zero(all.mass.rows());
  shape(dof) = 1.0;
  all.mass(dof, dof) = frame.mass;
  all.stiffness(dof, dof) = frame.mass * omega * omega;
  append_damper(all, shape, 2.0 * frame.damping_ratio * frame.mass * omega);
  all.outputs.col(dof).setConstant(-1.0);
  all.inputs.row(dof).setConstant(-1.0);
}

// The rows of the channels of one side. At height z the plate moves in-plane by z ψx and z ψy.
Eigen::MatrixXd channel_rows(const RitzModes& plate, const Eigen::MatrixX2d& places,
                             const Eigen::MatrixX2d& tilts, double height) {
  const auto rows = modal_rows(plate, places);
  if (tilts.rows() == 0) return rows.deflection;
  require(tilts.rows() == places.rows(), "a tilt for each channel is expected");
  const Eigen::VectorXd upright =
      (1.0 + tilts.rowwise().squaredNorm().array()).sqrt().inverse().matrix();
  return upright.asDiagonal() *
         (rows.deflection + height * (tilts.col(0).asDiagonal() * rows.turn_x +
                                      tilts.col(1).asDiagonal() * rows.turn_y));
}

Assembled assembled(const RitzStage& stage, const RitzGrid& grid) {
  check(stage);
  const Index n = stage.plate.mode_count();
  const Index size =
      n + static_cast<Index>(stage.resonators.size()) + (stage.frame.has_value() ? 1 : 0);
  const auto grown = [&](const Eigen::MatrixXd& matrix) {
    Eigen::MatrixXd larger = Eigen::MatrixXd::Zero(size, size);
    if (matrix.size() > 0) larger.topLeftCorner(n, n) = matrix;
    return larger;
  };
  const Eigen::VectorXd omega = 2.0 * pi * stage.plate.frequency_hz;
  Assembled all;
  all.mass = grown(Eigen::MatrixXd::Identity(n, n));
  all.stiffness = grown(omega.cwiseAbs2().asDiagonal());
  all.viscous = grown(stage.damping.viscous);
  all.loss = grown(stage.damping.loss);
  all.dampers.resize(size, 0);
  all.outputs = Eigen::MatrixXd::Zero(grid.outputs.rows(), size);
  all.outputs.leftCols(n) =
      channel_rows(stage.plate, grid.outputs, grid.output_tilts, grid.output_height);
  all.inputs = Eigen::MatrixXd::Zero(size, grid.inputs.rows());
  all.inputs.topRows(n) =
      channel_rows(stage.plate, grid.inputs, grid.input_tilts, grid.input_height).transpose();
  for (const auto& point : stage.points) add_point(all, stage.plate, point);
  Index dof = n;
  for (const auto& one : stage.resonators) add_resonator(all, stage.plate, one, dof++);
  for (const auto& pad : stage.pads) add_pad(all, stage.plate, pad);
  if (stage.frame) add_frame(all, *stage.frame, dof);
  const auto moving = [](const RitzPoint& p) {
    return p.mass > 0.0 || p.rotary_inertia > 0.0 || p.stiffness > 0.0;
  };
  all.attached = std::any_of(stage.points.begin(), stage.points.end(), moving) ||
                 !stage.resonators.empty() || !stage.pads.empty() || stage.frame.has_value();
  return all;
}

// Undamped modes of the whole stage, with the damping in their coordinates. The damping matrix is
// full between the first `low` modes.
struct Solved {
  Eigen::VectorXd lambda;
  Eigen::MatrixXd viscous, loss;            // low×low
  Eigen::VectorXd high_viscous, high_loss;  // the rest
  Eigen::MatrixXd dampers, outputs, inputs;
  Index low = 0;
};

bool is_diagonal(const Eigen::MatrixXd& matrix) {
  return (matrix - Eigen::MatrixXd(matrix.diagonal().asDiagonal())).isZero(0.0);
}

Index count_below(const Eigen::VectorXd& lambda, double highest_hz) {
  const double limit = 2.0 * pi * 6.0 * highest_hz;
  const auto below = (lambda.array() < limit * limit).count();
  return std::min(lambda.size(), std::max<Index>(40, below));
}

Solved solved(const Assembled& all, double highest_hz) {
  Solved modes;
  if (!all.attached && is_diagonal(all.viscous) && is_diagonal(all.loss)) {
    modes = {all.stiffness.diagonal(), {},          {},          all.viscous.diagonal(),
             all.loss.diagonal(),      all.dampers, all.outputs, all.inputs};
    return modes;
  }
  Eigen::MatrixXd psi;
  if (all.attached) {
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(all.stiffness, all.mass);
    if (solver.info() != Eigen::Success) throw NumericalFailure("modes of a Ritz stage");
    modes.lambda = solver.eigenvalues();
    psi = solver.eigenvectors();
  } else {
    modes.lambda = all.stiffness.diagonal();
    psi = Eigen::MatrixXd::Identity(modes.lambda.size(), modes.lambda.size());
  }
  modes.low = count_below(modes.lambda, highest_hz);
  const Index rest = psi.cols() - modes.low;
  const auto project = [&](const Eigen::MatrixXd& matrix, Eigen::MatrixXd& block,
                           Eigen::VectorXd& diagonal) {
    const Eigen::MatrixXd by = matrix * psi;
    block = psi.leftCols(modes.low).transpose() * by.leftCols(modes.low);
    diagonal = psi.rightCols(rest).cwiseProduct(by.rightCols(rest)).colwise().sum().transpose();
  };
  project(all.viscous, modes.viscous, modes.high_viscous);
  project(all.loss, modes.loss, modes.high_loss);
  modes.dampers = psi.transpose() * all.dampers;
  modes.outputs = all.outputs * psi;
  modes.inputs = psi.transpose() * all.inputs;
  return modes;
}

// The response between `left` (a×N) and `right` (N×b), without dashpots.
Eigen::MatrixXcd undashed(const Solved& modes, double omega, const Eigen::MatrixXd& left,
                          const Eigen::MatrixXd& right) {
  const Complex j(0.0, 1.0);
  const Index rest = modes.lambda.size() - modes.low;
  const Eigen::VectorXcd high =
      (modes.lambda.tail(rest).array() - omega * omega).cast<Complex>() +
      j * (omega * modes.high_viscous + modes.high_loss).array().cast<Complex>();
  Eigen::MatrixXcd sum =
      left.rightCols(rest) * high.cwiseInverse().asDiagonal() * right.bottomRows(rest);
  if (modes.low == 0) return sum;
  Eigen::MatrixXcd dynamic = j * (omega * modes.viscous + modes.loss).cast<Complex>();
  dynamic.diagonal() += (modes.lambda.head(modes.low).array() - omega * omega).matrix();
  sum += left.leftCols(modes.low) *
         dynamic.partialPivLu().solve(right.topRows(modes.low).cast<Complex>());
  return sum;
}

Eigen::MatrixXcd response(const Solved& modes, double omega) {
  const Index p = modes.outputs.rows();
  const Index q = modes.inputs.cols();
  const Index d = modes.dampers.cols();
  Eigen::MatrixXd left(p + d, modes.lambda.size());
  left << modes.outputs, modes.dampers.transpose();
  Eigen::MatrixXd right(modes.lambda.size(), q + d);
  right << modes.inputs, modes.dampers;
  const Eigen::MatrixXcd all = undashed(modes, omega, left, right);
  if (d == 0) return all;
  const Complex s(0.0, omega);
  const Eigen::MatrixXcd among = Eigen::MatrixXcd::Identity(d, d) + s * all.bottomRightCorner(d, d);
  return all.topLeftCorner(p, q) -
         s * all.topRightCorner(p, d) * among.partialPivLu().solve(all.bottomLeftCorner(d, q));
}

void check_lines(const RitzGrid& grid) {
  require(grid.frequency_hz.size() > 0 && grid.frequency_hz.minCoeff() > 0.0,
          "lines above 0 Hz are expected");
}

}  // namespace

RitzDamping modal_damping(const RitzModes& modes, double ratio, double exponent,
                          double reference_hz) {
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(modes.mode_count());
  for (Index k = 0; k < diagonal.size(); ++k) {
    const double f = modes.frequency_hz(k);
    if (f > 0.0) diagonal(k) = 4.0 * pi * f * ratio * std::pow(f / reference_hz, exponent);
  }
  return {diagonal.asDiagonal(), {}};
}

RitzDamping hysteretic_damping(const RitzModes& modes, double ratio) {
  const Index n = modes.mode_count();
  const Eigen::VectorXd lambda = (2.0 * pi * modes.frequency_hz).cwiseAbs2();
  return {Eigen::MatrixXd::Zero(n, n), (2.0 * ratio * lambda).asDiagonal()};
}

RitzDamping carried_over(const RitzDamping& damping, const RitzModes& from,
                         const RitzModes& modes) {
  require(from.body.degree == modes.body.degree &&
              from.body.degree_along_y() == modes.body.degree_along_y() &&
              same_shape(from.body, modes.body),
          "plates of two bases");
  // The same deflection gives smaller slopes on a larger plate.
  Eigen::MatrixXd stretched = modes.coefficients;
  stretched.bottomRows(2 * stretched.rows() / 3) *= modes.body.length / from.body.length;
  const Eigen::MatrixXd change = from.coefficients.partialPivLu().solve(stretched);
  RitzDamping seen{change.transpose() * damping.viscous * change, {}};
  if (damping.loss.size() > 0) seen.loss = change.transpose() * damping.loss * change;
  return seen;
}

std::vector<Eigen::MatrixXcd> ritz_receptance(const RitzStage& stage, const RitzGrid& grid) {
  check_lines(grid);
  const auto modes = solved(assembled(stage, grid), grid.frequency_hz.maxCoeff());
  const auto lines = static_cast<std::size_t>(grid.frequency_hz.size());
  std::vector<Eigen::MatrixXcd> value(lines);
  parallel_ranges(lines, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      value[k] = response(modes, 2.0 * pi * grid.frequency_hz(static_cast<Index>(k)));
    }
  });
  return value;
}

std::vector<Eigen::MatrixXcd> direct_receptance(const RitzStage& stage, const RitzGrid& grid) {
  check_lines(grid);
  const auto all = assembled(stage, grid);
  const Complex j(0.0, 1.0);
  std::vector<Eigen::MatrixXcd> value;
  for (const double hz : grid.frequency_hz) {
    const double omega = 2.0 * pi * hz;
    const Eigen::MatrixXd damping =
        omega * (all.viscous + all.dampers * all.dampers.transpose()) + all.loss;
    const Eigen::MatrixXcd dynamic =
        (all.stiffness - omega * omega * all.mass).cast<Complex>() + j * damping.cast<Complex>();
    value.emplace_back(all.outputs * dynamic.partialPivLu().solve(all.inputs.cast<Complex>()));
  }
  return value;
}

Eigen::VectorXd stage_frequencies_hz(const RitzStage& stage) {
  const auto all =
      assembled(stage, {Eigen::MatrixX2d::Zero(1, 2), Eigen::MatrixX2d::Zero(1, 2), {}});
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(all.stiffness, all.mass,
                                                                         Eigen::EigenvaluesOnly);
  return solver.eigenvalues().cwiseMax(0.0).cwiseSqrt() / (2.0 * pi);
}

}  // namespace chladni::simulators
