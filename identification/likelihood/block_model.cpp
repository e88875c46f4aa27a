#include "identification/likelihood/block_model.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "base/finite.h"
#include "identification/constants.h"

namespace chladni::identification {
namespace {

// Real part of v e^{jφ} with the φ that makes it largest, normalised.
Eigen::VectorXd turned_real(const Eigen::VectorXcd& v) {
  const double angle = 0.5 * std::arg((v.array() * v.array()).sum());
  const Eigen::VectorXd real = (v * std::polar(1.0, -angle)).real();
  return real / real.norm();
}

}  // namespace

Eigen::MatrixXd companion(const Block& block) {
  const auto g = block.size();
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(2 * g, 2 * g);
  a.topRightCorner(g, g).setIdentity();
  a.bottomLeftCorner(g, g) = -block.stiffness;
  a.bottomRightCorner(g, g) = -block.damping;
  return a;
}

Eigen::VectorXcd poles(const Block& block) {
  if (block.general) return Eigen::Vector2cd(block.pole, std::conj(block.pole));
  Eigen::VectorXcd all = finite(companion(block), "block of modes").eigenvalues();
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.imag() > b.imag(); });
  return all;
}

Block damped_after(Block block, const Block& before) {
  if (block.general) {
    const double least = std::max(kLeastDampingRatio * std::abs(block.pole),
                                  -Constants::damping_left * before.pole.real());
    block.pole.real(std::min(block.pole.real(), -least));
    block.pole.imag(std::max(block.pole.imag(), Constants::least_turning * std::abs(block.pole)));
  } else if (!block.rigid && block.size() == 1 && block.stiffness(0, 0) > 0.0) {
    const double least = std::max(2.0 * kLeastDampingRatio * std::sqrt(block.stiffness(0, 0)),
                                  Constants::damping_left * before.damping(0, 0));
    block.damping(0, 0) = std::max(block.damping(0, 0), least);
  }
  return block;
}

bool is_undamped(const Block& block) {
  constexpr double kAtBound = 1.0 + 1e-6;
  if (block.general)
    return -block.pole.real() <= kAtBound * kLeastDampingRatio * std::abs(block.pole);
  if (block.rigid || block.size() != 1) return false;
  return block.damping(0, 0) <=
         2.0 * kAtBound * kLeastDampingRatio * std::sqrt(block.stiffness(0, 0));
}

bool is_stable(const Block& block) {
  if (block.rigid) return true;
  if (block.general) return block.pole.real() < 0.0 && block.pole.imag() > 0.0;
  if (block.size() == 1) return block.stiffness(0, 0) > 0.0 && block.damping(0, 0) > 0.0;
  if (!block.stiffness.allFinite() || !block.damping.allFinite()) return false;
  return poles(block).real().maxCoeff() < 0.0;
}

Block balanced(const Block& block) {
  if (block.general) {  // a basis change would change A
    Block result = block;
    const double factor = std::sqrt(0.5 * block.right.norm() / std::max(1e-300, block.left.norm()));
    if (!(factor > 0.0) || !std::isfinite(factor)) return block;
    result.left *= factor;
    result.right /= factor;
    return result;
  }
  // left right = Q (A Bᵀ) Pᵀ by two thin QR: the singular values are those of the g×g matrix A Bᵀ.
  const auto g = block.size();
  const auto p = block.left.rows();
  const auto q = block.right.cols();
  if (p < g || q < g || !block.left.allFinite() || !block.right.allFinite()) return block;
  const Eigen::HouseholderQR<Eigen::MatrixXd> outputs(block.left);
  const Eigen::HouseholderQR<Eigen::MatrixXd> inputs(Eigen::MatrixXd(block.right.transpose()));
  const auto corner = [g](const auto& qr) {
    return Eigen::MatrixXd(qr.matrixQR().topRows(g).template triangularView<Eigen::Upper>());
  };
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(
      finite(Eigen::MatrixXd(corner(outputs) * corner(inputs).transpose()), "sides of a block"),
      Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::VectorXd root = svd.singularValues().cwiseSqrt();
  if (root(g - 1) <= 1e-12 * root(0)) return block;
  const Eigen::MatrixXd v = inputs.householderQ() * Eigen::MatrixXd::Identity(q, g) * svd.matrixV();
  Block result = block;
  result.left =
      outputs.householderQ() * Eigen::MatrixXd::Identity(p, g) * svd.matrixU() * root.asDiagonal();
  result.right = root.asDiagonal() * v.transpose();
  // new left = left T with T = right (new right)⁺.
  const Eigen::MatrixXd turn = block.right * v * root.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd back = turn.inverse();
  if (!block.rigid) {
    result.stiffness = back * block.stiffness * turn;
    result.damping = back * block.damping * turn;
  }
  return result;
}

std::vector<Block> diagonalised(const Block& block) {
  const auto g = block.size();
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(finite(companion(block), "block of modes"));
  std::vector<Eigen::Index> upper;
  for (Eigen::Index r = 0; r < 2 * g; ++r) {
    if (solver.eigenvalues()(r).imag() > 0.0) upper.push_back(r);
  }
  if (static_cast<Eigen::Index>(upper.size()) != g) return {};
  Eigen::MatrixXd turn(g, g);
  for (Eigen::Index r = 0; r < g; ++r) {
    turn.col(r) =
        turned_real(solver.eigenvectors().col(upper[static_cast<std::size_t>(r)]).head(g));
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(finite(turn, "shapes of a block"));
  if (svd.singularValues()(g - 1) < Constants::dependent_shapes * svd.singularValues()(0))
    return {};
  const Eigen::MatrixXd left = block.left * turn;
  const Eigen::MatrixXd right = turn.inverse() * block.right;
  std::vector<Block> modes;
  for (Eigen::Index r = 0; r < g; ++r) {
    modes.push_back(single_mode(solver.eigenvalues()(upper[static_cast<std::size_t>(r)]),
                                left.col(r), right.row(r)));
  }
  return modes;
}

std::vector<Block> forced_modes(const Block& block) {
  auto modes = diagonalised(block);
  if (!modes.empty()) return modes;
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(finite(block.stiffness, "stiffness of a block"));
  Eigen::MatrixXd turn = solver.eigenvectors().real();
  if (turn.fullPivLu().rank() < block.size()) turn.setIdentity(block.size(), block.size());
  const Eigen::MatrixXd back = turn.inverse();
  const Eigen::MatrixXd damping = back * block.damping * turn;
  const Eigen::MatrixXd left = block.left * turn;
  const Eigen::MatrixXd right = back * block.right;
  for (Eigen::Index r = 0; r < block.size(); ++r) {
    const double own = std::sqrt(std::abs(solver.eigenvalues()(r)));
    const double half = std::clamp(0.5 * std::abs(damping(r, r)), 1e-9 * own, 0.99 * own);
    modes.push_back(
        single_mode({-half, std::sqrt(own * own - half * half)}, left.col(r), right.row(r)));
  }
  return modes;
}

Block single_mode(std::complex<double> pole, const Eigen::VectorXd& left,
                  const Eigen::RowVectorXd& right) {
  return {.left = left,
          .right = right,
          .stiffness = Eigen::MatrixXd::Constant(1, 1, std::norm(pole)),
          .damping = Eigen::MatrixXd::Constant(1, 1, -2.0 * pole.real())};
}

Block general_mode(std::complex<double> pole, const Eigen::VectorXcd& l,
                   const Eigen::RowVectorXcd& r) {
  Block block;
  block.left.resize(l.size(), 2);
  block.left << l.real(), l.imag();
  block.right.resize(2, r.size());
  block.right << 2.0 * r.real(), -2.0 * r.imag();
  block.general = true;
  block.pole = pole;
  return balanced(block);
}

}  // namespace chladni::identification
