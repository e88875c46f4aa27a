#include "identification/gains/matched_sides.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/finite.h"

namespace chladni::identification {

namespace {

Eigen::VectorXd at_ties(const Eigen::VectorXd& values, const std::vector<Eigen::Index>& which) {
  return values(which);
}

OneScale on_scale(const Eigen::VectorXd& outputs, const Eigen::VectorXd& inputs, double alpha) {
  OneScale scaled;
  scaled.outputs = outputs / alpha;
  scaled.inputs = alpha * inputs;
  scaled.at_inputs = scaled.inputs;
  scaled.log_alpha = std::log(alpha);
  return scaled;
}

// A of the gaps d = A x with x = (L, R): L_c − β ratio_c R_c.
Eigen::MatrixXd constraint(const TwoSides& mode, double beta) {
  const auto p = mode.outputs.size();
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(mode.ties.count(), p + mode.inputs.size());
  for (Eigen::Index c = 0; c < mode.ties.count(); ++c) {
    rows(c, mode.ties.outputs[static_cast<std::size_t>(c)]) = 1.0;
    rows(c, p + mode.ties.inputs[static_cast<std::size_t>(c)]) = -beta * mode.ties.ratio(c);
  }
  return rows;
}

Eigen::MatrixXd gap_covariance(const TwoSides& mode, const Eigen::MatrixXd& rows) {
  const auto p = mode.outputs.size();
  Eigen::MatrixXd spread = rows * mode.covariance * rows.transpose();
  for (Eigen::Index c = 0; c < mode.ties.count(); ++c) {
    const auto input = mode.ties.inputs[static_cast<std::size_t>(c)];
    const double slope = rows(c, p + input) / mode.ties.ratio(c) * mode.inputs(input);
    spread(c, c) += std::pow(slope * mode.ties.ratio_std(c), 2);
  }
  return spread;
}

// C with two additions: a large variance in the direction that exchanges scale between L and R, and
// the deviation from rigid motion. 1e-8 of the size stands for rounding.
Eigen::MatrixXd motion_covariance(const TwoSides& mode, double bending) {
  const auto p = mode.outputs.size();
  const auto q = mode.inputs.size();
  Eigen::VectorXd trade(p + q);
  trade << mode.outputs, -mode.inputs;
  Eigen::MatrixXd covariance = mode.covariance;
  covariance += mode.covariance.trace() / trade.squaredNorm() * trade * trade.transpose();
  const double part = 1e-16 + bending * bending;
  covariance.diagonal().head(p).array() +=
      part * mode.outputs.squaredNorm() / static_cast<double>(p);
  covariance.diagonal().tail(q).array() +=
      part * mode.inputs.squaredNorm() / static_cast<double>(q);
  return covariance;
}

// x = (α P_s c, P_a c / α): one Gauss-Newton step of ln α; c by least squares.
struct MotionStep {
  Eigen::VectorXd coefficients;
  double step = 0.0, chi_square = 0.0;
};

MotionStep motion_step(const Eigen::LLT<Eigen::MatrixXd>& whiten, const Eigen::MatrixXd& rows,
                       const Eigen::VectorXd& x, Eigen::Index q) {
  const auto white = [&](const Eigen::MatrixXd& any) -> Eigen::MatrixXd {
    return whiten.matrixL().solve(any);
  };
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  qr.setThreshold(1e-10);
  qr.compute(white(rows));
  if (qr.rank() < rows.cols()) {
    throw NumericalFailure("the places do not determine the rigid motion");
  }
  MotionStep next;
  next.coefficients = qr.solve(Eigen::VectorXd(white(x)));
  const Eigen::VectorXd left = white(x - rows * next.coefficients);
  next.chi_square = left.squaredNorm();
  Eigen::VectorXd slope = rows * next.coefficients;
  slope.tail(q) *= -1.0;
  const Eigen::VectorXd full = white(slope);
  const Eigen::VectorXd along = full - white(rows) * qr.solve(full);
  if (!(along.norm() > 1e-6 * full.norm())) {
    throw NumericalFailure("the places do not determine the scale of the rigid motion");
  }
  next.step = std::clamp(along.dot(left) / along.squaredNorm(), -1.0, 1.0);
  return next;
}

// Rows of L_c S = ratio R_cᵀ; the unknowns are the entries of the symmetric S.
Eigen::MatrixXd block_design(const Eigen::MatrixXd& l) {
  const auto n = l.rows();
  const auto g = l.cols();
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(n * g, g * (g + 1) / 2);
  Eigen::Index column = 0;
  for (Eigen::Index b = 0; b < g; ++b) {
    for (Eigen::Index a = b; a < g; ++a, ++column) {
      rows.block(b * n, column, n, 1) += l.col(a);
      if (a != b) rows.block(a * n, column, n, 1) += l.col(b);
    }
  }
  return rows;
}

}  // namespace

OneScale scaled_by_thesis(const TwoSides& mode) {
  const Eigen::VectorXd l = at_ties(mode.outputs, mode.ties.outputs);
  const Eigen::VectorXd r = at_ties(mode.inputs, mode.ties.inputs).cwiseProduct(mode.ties.ratio);
  return on_scale(mode.outputs, mode.inputs, std::sqrt(l.norm() / r.norm()));
}

OneScale scaled_by_ties(const TwoSides& mode) {
  const auto start = scaled_by_thesis(mode);
  const auto p = mode.outputs.size();
  const auto q = mode.inputs.size();
  Eigen::VectorXd x(p + q);
  x << mode.outputs, mode.inputs;
  const Eigen::VectorXd l = at_ties(mode.outputs, mode.ties.outputs);
  const Eigen::VectorXd r = at_ties(mode.inputs, mode.ties.inputs).cwiseProduct(mode.ties.ratio);
  Eigen::VectorXd moved = x;
  double beta = std::exp(2.0 * start.log_alpha);
  double chi_square = 0.0;
  for (int iteration = 0; iteration < 100; ++iteration) {
    const Eigen::MatrixXd a = constraint(mode, beta);
    const Eigen::LDLT<Eigen::MatrixXd> factor(gap_covariance(mode, a));
    if (!(factor.isPositive() && factor.rcond() > 1e-13)) return start;
    const Eigen::VectorXd gap = l - beta * r;
    moved = x - mode.covariance * a.transpose() * factor.solve(gap);
    chi_square = gap.dot(factor.solve(gap));
    // Condition for a stationary β: λᵀ dA/dβ x = 0 with the moved x.
    const Eigen::VectorXd weight = factor.solve(
        Eigen::VectorXd(at_ties(moved.tail(q), mode.ties.inputs).cwiseProduct(mode.ties.ratio)));
    const double next = weight.dot(l) / weight.dot(r);
    if (!(next > 0.0)) return start;
    const double change = std::abs(next / beta - 1.0);
    beta = next;
    if (change < 1e-14) break;
  }
  auto scaled = on_scale(moved.head(p), moved.tail(q), std::sqrt(beta));
  scaled.chi_square = chi_square;
  return scaled;
}

OneScale scaled_by_motion(const TwoSides& mode, const Eigen::MatrixXd& outputs,
                          const Eigen::MatrixXd& inputs, double bending) {
  const auto q = mode.inputs.size();
  Eigen::VectorXd x(mode.outputs.size() + q);
  x << mode.outputs, mode.inputs;
  const Eigen::LLT<Eigen::MatrixXd> whiten(motion_covariance(mode, bending));
  double log_alpha = 0.5 * std::log(mode.outputs.norm() / mode.inputs.norm());
  MotionStep last;
  for (int iteration = 0; iteration < 100; ++iteration) {
    Eigen::MatrixXd rows(x.size(), outputs.cols());
    rows << std::exp(log_alpha) * outputs, std::exp(-log_alpha) * inputs;
    last = motion_step(whiten, rows, x, q);
    if (std::abs(last.step) < 1e-14) break;
    log_alpha += last.step;
  }
  OneScale scaled;
  scaled.outputs = outputs * last.coefficients;
  scaled.inputs = scaled.at_inputs = inputs * last.coefficients;
  scaled.log_alpha = log_alpha;
  scaled.chi_square = last.chi_square;
  return scaled;
}

OneScale extrapolated_from_sensors(const TwoSides& mode, const Eigen::MatrixXd& outputs,
                                   const Eigen::MatrixXd& inputs) {
  auto scaled = scaled_by_thesis(mode);
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(outputs);
  qr.setThreshold(1e-10);
  if (qr.rank() < outputs.cols()) {
    throw NumericalFailure("too few sensors for the rigid motion");
  }
  scaled.at_inputs = inputs * qr.solve(scaled.outputs);
  return scaled;
}

Eigen::MatrixXd block_transformation(const Eigen::MatrixXd& outputs, const Eigen::MatrixXd& inputs,
                                     const Ties& ties) {
  const auto g = outputs.cols();
  const Eigen::MatrixXd l = outputs(ties.outputs, Eigen::all);
  const Eigen::MatrixXd r = ties.ratio.asDiagonal() * inputs(Eigen::all, ties.inputs).transpose();
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  qr.setThreshold(1e-8);
  qr.compute(block_design(l));
  if (qr.rank() < g * (g + 1) / 2) {
    throw NumericalFailure("the pairs do not determine how the block's sides belong together");
  }
  const Eigen::VectorXd entries = qr.solve(Eigen::VectorXd(r.reshaped()));
  Eigen::MatrixXd square(g, g);
  Eigen::Index column = 0;
  for (Eigen::Index b = 0; b < g; ++b) {
    for (Eigen::Index a = b; a < g; ++a) square(a, b) = square(b, a) = entries(column++);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      finite(square, "sides of a block at the pairs"));
  if (!(solver.eigenvalues()(0) > 1e-10 * solver.eigenvalues()(g - 1))) {
    throw NumericalFailure("the sides of the block do not belong together at the pairs");
  }
  return solver.operatorSqrt();
}

Eigen::MatrixXd covariance_factor(const Eigen::MatrixXd& covariance) {
  if (covariance.size() == 0) return covariance;
  const Eigen::VectorXd scale = covariance.diagonal().cwiseMax(0.0).cwiseSqrt().cwiseMax(1e-300);
  const Eigen::MatrixXd scaled =
      scale.cwiseInverse().asDiagonal() * covariance * scale.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      finite(scaled, "covariance of a mode"));
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    if (solver.eigenvalues()(i) > 1e-12) kept.push_back(i);
  }
  return scale.asDiagonal() * solver.eigenvectors()(Eigen::all, kept) *
         solver.eigenvalues()(kept).cwiseSqrt().asDiagonal();
}

Eigen::MatrixXd propagated_factor(
    const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& value, const Eigen::VectorXd& x,
    const Eigen::MatrixXd& factor) {
  constexpr double kStep = 0.05;  // of a deviation
  Eigen::MatrixXd change(value(x).size(), factor.cols());
  try {
    for (Eigen::Index i = 0; i < factor.cols(); ++i) {
      const Eigen::VectorXd step = kStep * factor.col(i);
      change.col(i) = (value(x + step) - value(x - step)) / (2.0 * kStep);
    }
  } catch (const NumericalFailure&) {  // value() fails for nearby x
    change.setConstant(std::numeric_limits<double>::infinity());
  }
  return change;
}

Eigen::VectorXd propagated(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& value,
                           const Eigen::VectorXd& x, const Eigen::MatrixXd& factor) {
  return propagated_factor(value, x, factor).rowwise().norm();
}

}  // namespace chladni::identification
