#include "identification/likelihood/block_fractions.h"

#include <cmath>

#include "base/decompositions.h"
#include "base/finite.h"

namespace chladni::identification {
namespace {

using Complex = std::complex<double>;

constexpr double kLeastGap = 1e-9;  // least relative gap between poles of one block

void split_single(const Block& block, BlockFractions& result) {
  const double half = 0.5 * block.damping(0, 0);
  const Complex root = std::sqrt(Complex(half * half - block.stiffness(0, 0), 0.0));
  const Complex above = -half + root;
  Complex below = -half - root;
  if (std::abs(above - below) < kLeastGap * std::abs(above)) below *= 1.0 + kLeastGap;
  result.pole.resize(2);
  result.pole << above, below;
  result.x.setOnes(1, 2);
  result.y.resize(2, 1);
  result.y << 1.0 / (above - below), 1.0 / (below - above);
}

// Uses the eigenvectors of the companion form.
void split_coupled(const Block& block, BlockFractions& result) {
  const auto g = block.size();
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(finite(companion(block), "block of modes"));
  result.pole = solver.eigenvalues();
  result.x = solver.eigenvectors().topRows(g);
  result.y = solver.eigenvectors().inverse().rightCols(g);
  for (Eigen::Index r = 0; r < 2 * g; ++r) {
    for (Eigen::Index t = 0; t < r; ++t) {
      if (std::abs(result.pole(r) - result.pole(t)) < kLeastGap * std::abs(result.pole(r))) {
        result.pole(r) *= 1.0 + kLeastGap * static_cast<double>(r);
      }
    }
  }
}

// Uses A (1, j)ᵀ = p (1, j)ᵀ.
void split_general(const Block& block, BlockFractions& result) {
  const Complex j(0.0, 1.0);
  result.pole = poles(block);
  result.x.resize(2, 2);
  result.x << 1.0, 1.0, j, -j;
  result.y.resize(2, 2);
  result.y << 0.5, -0.5 * j, 0.5, 0.5 * j;
}

// Derivatives for a general block. σ and ω move only its pole and the conjugate.
SmallComplex general_derivatives(const BlockFractions& parts, Eigen::Index i, Eigen::Index j) {
  SmallComplex result = SmallComplex::Zero(4, 6);
  for (Eigen::Index r = 0; r < 2; ++r) {
    for (Eigen::Index a = 0; a < 2; ++a) {
      result(r, a) = parts.x(a, r) * parts.right(r, j);
      result(r, 2 + a) = parts.left(i, r) * parts.y(r, a);
    }
    const Complex square = parts.left(i, r) * parts.right(r, j);
    result(2 + r, 4) = square;
    result(2 + r, 5) = Complex(0.0, r == 0 ? 1.0 : -1.0) * square;
  }
  return result;
}

}  // namespace

BlockFractions fractions(const Block& block) {
  BlockFractions result;
  if (block.general) {
    split_general(block, result);
  } else if (block.size() == 1) {
    split_single(block, result);
  } else {
    split_coupled(block, result);
  }
  result.left = block.left.cast<Complex>() * result.x;
  result.right = result.y * block.right.cast<Complex>();
  return result;
}

std::vector<Block> general_modes(const Block& block) {
  const auto parts = fractions(block);
  std::vector<Block> modes;
  for (Eigen::Index r = 0; r < parts.pole.size(); ++r) {
    if (parts.pole(r).imag() <= 0.0) continue;
    modes.push_back(general_mode(parts.pole(r), parts.left.col(r), parts.right.row(r)));
  }
  if (2 * static_cast<Eigen::Index>(modes.size()) != parts.pole.size()) return {};
  return modes;
}

SmallComplex derivatives(const Block& block, const BlockFractions& parts, Eigen::Index i,
                         Eigen::Index j) {
  if (block.general) return general_derivatives(parts, i, j);
  const auto g = block.size();
  if (block.rigid) {
    SmallComplex result(1, 2 * g);
    result << block.right.col(j).transpose().cast<Complex>(), block.left.row(i).cast<Complex>();
    return result;
  }
  const auto n = 2 * g;
  SmallComplex result = SmallComplex::Zero(2 * n, 2 * g + 2 * g * g);
  for (Eigen::Index a = 0; a < g; ++a) {
    for (Eigen::Index r = 0; r < n; ++r) {
      result(r, a) = parts.x(a, r) * parts.right(r, j);     // (H right)_a
      result(r, g + a) = parts.left(i, r) * parts.y(r, a);  // (left H)_a
    }
  }
  for (Eigen::Index b = 0; b < g; ++b) {
    for (Eigen::Index a = 0; a < g; ++a) {  // −(left H)_a (H right)_b; s times it for damping
      const auto stiffness = 2 * g + a + g * b;
      const auto damping = stiffness + g * g;
      for (Eigen::Index r = 0; r < n; ++r) {
        const Complex one = result(r, g + a);
        const Complex other = result(r, b);
        const Complex square = -one * other;
        Complex plain = 0.0;
        for (Eigen::Index t = 0; t < n; ++t) {
          if (t == r) continue;
          plain -=
              (one * result(t, b) + result(t, g + a) * other) / (parts.pole(r) - parts.pole(t));
        }
        result(r, stiffness) = plain;
        result(n + r, stiffness) = square;
        result(r, damping) = plain * parts.pole(r) + square;
        result(n + r, damping) = square * parts.pole(r);
      }
    }
  }
  return result;
}

}  // namespace chladni::identification
