#include "fem/symmetry/symmetry_class.h"

#include <Eigen/Dense>
#include <cstddef>

#include "base/error.h"
#include "fem/eigen/symmetric_product.h"

namespace chladni::fem {
namespace {

using Matrix = Eigen::MatrixXd;

// Every product of some of the mirrors: element g has mirror k where bit k of g is set.
std::vector<Mirror> group_of(const std::vector<Mirror>& mirrors) {
  const auto n = mirrors.front().image.size();
  Mirror nothing{0, Eigen::VectorXi::LinSpaced(n, 0, static_cast<int>(n) - 1),
                 Eigen::VectorXd::Ones(n)};
  std::vector<Mirror> group{std::move(nothing)};
  for (const auto& mirror : mirrors) {
    const auto before = group.size();
    for (std::size_t g = 0; g < before; ++g) {
      Mirror both = group[g];
      for (Eigen::Index i = 0; i < n; ++i) {
        const int at = group[g].image(i);
        both.image(i) = mirror.image(at);
        both.sign(i) *= mirror.sign(at);
      }
      group.push_back(std::move(both));
    }
  }
  return group;
}

// The character of element g in the class whose bits say about which planes it is odd.
double character(std::size_t odd, std::size_t g) {
  double result = 1.0;
  for (std::size_t common = odd & g; common > 0; common >>= 1U) {
    if ((common & 1U) != 0) result = -result;
  }
  return result;
}

SymmetryClass class_of(const std::vector<Mirror>& group, std::size_t odd) {
  const auto n = group.front().image.size();
  SymmetryClass result{Eigen::VectorXi::Constant(n, -1), Eigen::VectorXd::Zero(n), {}, {}};
  std::vector<int> first;
  std::vector<double> members;
  for (Eigen::Index i = 0; i < n; ++i) {
    bool is_first = true;
    double fixed = 0.0;  // sum over the elements that leave i where it is
    double in_place = 0.0;
    for (std::size_t g = 0; g < group.size(); ++g) {
      is_first = is_first && group[g].image(i) >= i;
      if (group[g].image(i) != i) continue;
      fixed += character(odd, g) * group[g].sign(i);
      in_place += 1.0;
    }
    if (!is_first || fixed == 0.0) continue;
    for (std::size_t g = 0; g < group.size(); ++g) {
      result.coordinate(group[g].image(i)) = static_cast<int>(first.size());
      result.value(group[g].image(i)) = character(odd, g) * group[g].sign(i);
    }
    first.push_back(static_cast<int>(i));
    members.push_back(static_cast<double>(group.size()) / in_place);
  }
  result.first = Eigen::Map<Eigen::VectorXi>(first.data(), static_cast<Eigen::Index>(first.size()));
  result.members =
      Eigen::Map<Eigen::VectorXd>(members.data(), static_cast<Eigen::Index>(members.size()));
  return result;
}

// PᵀAP of a matrix that is its own image: row `first` of each coordinate, times its members.
SparseMatrix block_of(const SparseMatrix& matrix, const SymmetryClass& symmetry) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(matrix.nonZeros() * symmetry.size() / matrix.cols()));
  const auto add = [&](Eigen::Index row, Eigen::Index column, double value) {
    const int a = symmetry.coordinate(row);
    const int b = symmetry.coordinate(column);
    if (b < 0 || a < b || symmetry.first(a) != row) return;
    entries.emplace_back(a, b, symmetry.members(a) * symmetry.value(column) * value);
  };
  for (Eigen::Index c = 0; c < matrix.cols(); ++c) {
    for (SparseMatrix::InnerIterator entry(matrix, c); entry; ++entry) {
      add(entry.row(), c, entry.value());
      if (entry.row() != c) add(c, entry.row(), entry.value());
    }
  }
  SparseMatrix block(symmetry.size(), symmetry.size());
  block.setFromTriplets(entries.begin(), entries.end());
  return block;
}

// The coordinates of the even and odd parts of motions: their mean over the exchanged ones.
Matrix coordinates(const SymmetryClass& symmetry, const Matrix& motions) {
  return symmetry.members.cwiseInverse().asDiagonal() * gathered(symmetry, motions);
}

// Combinations of M-orthonormal motions whose parts in the class are M-orthonormal: q×q'. A mirror
// leaves the span of the motions as it is, so each part's squared norm is 1 or 0.
Matrix combinations(const SparseMatrix& mass, const Matrix& parts) {
  if (parts.cols() == 0) return Matrix(0, 0);
  const Matrix gram = parts.transpose() * (SymmetricProduct(mass) * parts);
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(Matrix(0.5 * (gram + gram.transpose())));
  const auto count = (solver.eigenvalues().array() > 0.5).count();
  return solver.eigenvectors().rightCols(count) *
         solver.eigenvalues().tail(count).cwiseSqrt().cwiseInverse().asDiagonal();
}

}  // namespace

std::vector<SymmetryClass> symmetry_classes(const std::vector<Mirror>& mirrors) {
  require(!mirrors.empty() && mirrors.size() <= 3, "modes: one to three mirrors are expected");
  const auto group = group_of(mirrors);
  std::vector<SymmetryClass> classes;
  for (std::size_t odd = 0; odd < group.size(); ++odd) {
    auto symmetry = class_of(group, odd);
    if (symmetry.size() > 0) classes.push_back(std::move(symmetry));
  }
  return classes;
}

Matrix expanded(const SymmetryClass& symmetry, const Matrix& x) {
  Matrix u = Matrix::Zero(symmetry.value.size(), x.cols());
  for (Eigen::Index k = 0; k < x.cols(); ++k) {
    for (Eigen::Index i = 0; i < u.rows(); ++i) {
      if (symmetry.coordinate(i) >= 0) {
        u(i, k) = symmetry.value(i) * x(symmetry.coordinate(i), k);
      }
    }
  }
  return u;
}

Matrix gathered(const SymmetryClass& symmetry, const Matrix& u) {
  Matrix x = Matrix::Zero(symmetry.size(), u.cols());
  for (Eigen::Index k = 0; k < u.cols(); ++k) {
    for (Eigen::Index i = 0; i < u.rows(); ++i) {
      if (symmetry.coordinate(i) >= 0) {
        x(symmetry.coordinate(i), k) += symmetry.value(i) * u(i, k);
      }
    }
  }
  return x;
}

System block_of(const System& system, const SymmetryClass& symmetry) {
  System block;
  block.stiffness = block_of(system.stiffness, symmetry);
  block.mass = block_of(system.mass, symmetry);
  const auto n = symmetry.size();
  block.dofs.free_count = n;
  block.frequency_scale_hz = system.frequency_scale_hz;
  if (system.positions.rows() > 0) block.positions = system.positions(symmetry.first, Eigen::all);
  block.rigid.resize(n, 0);
  block.suspended.resize(n, 0);
  block.suspension_force.resize(n, 0);
  if (system.rigid.cols() > 0) {
    const Matrix parts = coordinates(symmetry, system.rigid);
    block.rigid = parts * combinations(block.mass, parts);
  }
  if (system.suspended.cols() > 0) {
    const Matrix parts = coordinates(symmetry, system.suspended);
    const Matrix chosen = combinations(block.mass, parts);
    block.suspended = parts * chosen;
    block.suspension_force = gathered(symmetry, system.suspension_force) * chosen;
  }
  return block;
}

}  // namespace chladni::fem
