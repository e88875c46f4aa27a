#include "identification/likelihood/uncertainty/covariance.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>
#include <limits>
#include <vector>

#include "base/finite.h"
#include "dense/algebra.h"

namespace chladni::identification {
namespace {

// Basis changes of a block that change no response.
std::vector<Eigen::MatrixXd> idle_changes(const Block& block) {
  if (block.general) {  // the matrices that commute with A
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

// The changes of (left, right) by them: left += left T, right −= T right.
Eigen::MatrixXd idle_of(const Block& block) {
  const auto lefts = block.left.size();
  const auto changes = idle_changes(block);
  Eigen::MatrixXd idle(lefts + block.right.size(), static_cast<Eigen::Index>(changes.size()));
  for (std::size_t c = 0; c < changes.size(); ++c) {
    auto column = idle.col(static_cast<Eigen::Index>(c));
    column.head(lefts) = (block.left * changes[c]).reshaped();
    column.tail(block.right.size()) = -(changes[c] * block.right).reshaped();
  }
  return idle;
}

// Those of each part by itself. A part that does not see all modes of a block has fewer.
Eigen::MatrixXd idle_in_parts(const Block& block, const Parts& parts) {
  constexpr double kDependent = 1e-9;
  Eigen::MatrixXd idle(block.left.size() + block.right.size(), 0);
  for (const auto& part : parts) {
    const Eigen::MatrixXd own = idle_of(block_at(block, part));
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(own);
    qr.setThreshold(kDependent);
    const auto before = idle.cols();
    idle.conservativeResize(Eigen::NoChange, before + qr.rank());
    for (Eigen::Index c = 0; c < qr.rank(); ++c) {
      idle.col(before + c) = own.col(qr.colsPermutation().indices()(c));
    }
  }
  return idle;
}

// Parameters that no data determine.
Unknown untold_parameters(const Eigen::MatrixXd& symmetric) {
  Unknown unknown = !(symmetric.diagonal().array() > 0.0);
  for (Eigen::Index i = 0; i < unknown.size(); ++i) {
    unknown(i) = unknown(i) || !std::isfinite(symmetric(i, i));
  }
  return unknown;
}

// Parameters that a bound holds.
Unknown held_parameters(const BlockModel& model, Eigen::Index count_of_all) {
  Unknown held = Unknown::Constant(count_of_all, false);
  Eigen::Index first = 0;
  for (const auto& block : model.blocks) {
    const auto count = parameter_count(block);
    if (is_undamped(block)) held(first + count - (block.general ? 2 : 1)) = true;
    first += count;
  }
  return held;
}

// A⁻¹ of a matrix with a unit diagonal. Directions below double precision are left out; parameters
// with a share of a hundredth or more in them become unknown.
Eigen::MatrixXd inverse_of_told(const Eigen::MatrixXd& a, Unknown& unknown) {
  constexpr double kTold = 1e-13;
  constexpr double kShare = 1e-4;  // squared
  Eigen::MatrixXd factor = finite(a, "covariance of a fit");
  if (dense::cholesky(factor)) {
    dense::invert(factor);
    factor.triangularView<Eigen::StrictlyUpper>() = factor.transpose();
    if (factor.allFinite()) return factor;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(a);
  const auto told = solver.eigenvalues().array() > kTold;
  const Eigen::VectorXd inverse = told.select(solver.eigenvalues().cwiseInverse(), 0.0);
  const Eigen::MatrixXd& v = solver.eigenvectors();
  const Eigen::VectorXd untold = (!told).cast<double>();
  unknown = unknown || (v.cwiseAbs2() * untold).array() > kShare;
  return finite(Eigen::MatrixXd(v * inverse.asDiagonal() * v.transpose()), "covariance of a fit");
}

// The inverse that keeps the idle directions still. `unknown` grows by what no data tell; their
// rows and columns are zero.
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& symmetric, const Eigen::MatrixXd& idle,
                           Unknown& unknown) {
  const Eigen::VectorXd size = unknown.select(0.0, symmetric.diagonal().array().sqrt());
  const Eigen::VectorXd scale = unknown.select(0.0, size.array().inverse());
  Eigen::MatrixXd a = symmetric;
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    if (!unknown(i)) continue;
    a.row(i).setZero();
    a.col(i).setZero();
  }
  a = scale.asDiagonal() * a * scale.asDiagonal();
  a.diagonal() += unknown.matrix().cast<double>();
  const Eigen::MatrixXd q = dense::orthonormal_basis(size.asDiagonal() * idle);
  a += q * q.transpose();
  const Eigen::MatrixXd inverse =
      scale.asDiagonal() * inverse_of_told(a, unknown) * scale.asDiagonal();
  const Eigen::MatrixXd own = dense::orthonormal_basis(idle);
  const Eigen::MatrixXd half = inverse - own * (own.transpose() * inverse);
  Eigen::MatrixXd result = half - (half * own) * own.transpose();
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    if (!unknown(i)) continue;
    result.row(i).setZero();
    result.col(i).setZero();
  }
  return result;
}

}  // namespace

Eigen::MatrixXd idle_directions(const BlockModel& model, Eigen::Index parameters,
                                const Parts& parts) {
  std::vector<Eigen::MatrixXd> all;
  Eigen::Index count = 0;
  for (const auto& block : model.blocks) {
    all.push_back(parts.size() < 2 ? idle_of(block) : idle_in_parts(block, parts));
    count += all.back().cols();
  }
  Eigen::MatrixXd idle = Eigen::MatrixXd::Zero(parameters, count);
  Eigen::Index column = 0;
  Eigen::Index first = 0;
  for (std::size_t b = 0; b < all.size(); ++b) {
    idle.block(first, column, all[b].rows(), all[b].cols()) = all[b];
    column += all[b].cols();
    first += parameter_count(model.blocks[b]);
  }
  return idle;
}

Covariance held_inverse(const BlockModel& model, const NormalEquations& normal,
                        const Eigen::MatrixXd& idle) {
  const Eigen::MatrixXd symmetric = normal.matrix.selfadjointView<Eigen::Lower>();
  const Unknown untold = untold_parameters(symmetric);
  const Unknown held = held_parameters(model, symmetric.rows());
  Covariance result;
  result.unknown = untold || held;
  result.matrix = inverse_of(symmetric, idle, result.unknown);
  result.held_variance = Eigen::VectorXd::Zero(symmetric.rows());
  if (!held.any()) return result;
  Unknown open = untold;
  const Eigen::VectorXd free = inverse_of(symmetric, idle, open).diagonal().cwiseMax(0.0);
  for (Eigen::Index i = 0; i < held.size(); ++i) {
    if (!held(i)) continue;
    result.held_variance(i) = open(i) ? std::numeric_limits<double>::infinity() : free(i);
  }
  return result;
}

}  // namespace chladni::identification
