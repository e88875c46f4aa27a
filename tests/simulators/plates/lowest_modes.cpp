#include "simulators/plates/lowest_modes.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <string>

#include "base/error.h"
#include "simulators/portable_random.h"

namespace chladni::simulators {
namespace {

constexpr Eigen::Index kBlock = 6;
constexpr double kTolerance = 1e-11;  // of a Ritz value's residual, relative to it

// Makes the columns M-orthonormal to each other.
void orthonormalise(const Eigen::SparseMatrix<double>& mass, Eigen::MatrixXd& block) {
  for (int pass = 0; pass < 2; ++pass) {
    const Eigen::MatrixXd gram = block.transpose() * (mass.selfadjointView<Eigen::Lower>() * block);
    const Eigen::LLT<Eigen::MatrixXd> factor(gram);
    if (factor.info() != Eigen::Success) {
      throw NumericalFailure(
          "lowest modes: the mass is not positive definite, or the space is used up");
    }
    factor.matrixU().solveInPlace<Eigen::OnTheRight>(block);
  }
}

// An M-orthonormal basis that grows by blocks, with the operator projected on it.
struct Krylov {
  const Pencil& pencil;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor;
  Eigen::MatrixXd rigid, mass_rigid;  // M-orthonormal
  Eigen::MatrixXd basis, mass_basis;  // columns used: size
  Eigen::MatrixXd projected;          // basisᵀ M A basis
  Eigen::Index size = 0;

  Krylov(const Pencil& p, double s, Eigen::Index most) : pencil(p), rigid(p.rigid) {
    factor.compute(p.stiffness + s * p.mass);
    if (factor.info() != Eigen::Success) {
      throw NumericalFailure("lowest modes: K + sM is not positive definite");
    }
    orthonormalise(p.mass, rigid);
    mass_rigid = times_mass(rigid);
    basis.resize(p.mass.rows(), most);
    mass_basis = basis;
    projected = Eigen::MatrixXd::Zero(most, most);
  }

  [[nodiscard]] Eigen::MatrixXd times_mass(const Eigen::MatrixXd& x) const {
    return pencil.mass.selfadjointView<Eigen::Lower>() * x;
  }

  void deflate(Eigen::MatrixXd& block) const {
    for (int pass = 0; pass < 2; ++pass) {
      block -= rigid * (mass_rigid.transpose() * block);
      block -= basis.leftCols(size) * (mass_basis.leftCols(size).transpose() * block);
    }
  }

  // Adds the block and returns its image under (K + sM)⁻¹M, without rigid motions.
  Eigen::MatrixXd extend(Eigen::MatrixXd block) {
    deflate(block);
    orthonormalise(pencil.mass, block);
    deflate(block);
    orthonormalise(pencil.mass, block);
    const Eigen::Index added = block.cols();
    basis.middleCols(size, added) = block;
    mass_basis.middleCols(size, added) = times_mass(block);
    Eigen::MatrixXd image = factor.solve(mass_basis.middleCols(size, added));
    image -= rigid * (mass_rigid.transpose() * image);
    size += added;
    const Eigen::MatrixXd column = mass_basis.leftCols(size).transpose() * image;
    projected.block(0, size - added, size, added) = column;
    projected.block(size - added, 0, added, size) = column.transpose();
    return image;
  }

  // The Gram matrix, in the M inner product, of the part of the image outside the basis.
  [[nodiscard]] Eigen::MatrixXd outside(const Eigen::MatrixXd& image) const {
    Eigen::MatrixXd rest = image;
    deflate(rest);
    return rest.transpose() * times_mass(rest);
  }
};

// The result of Rayleigh-Ritz of K in the space of the columns.
LowestModes settled(const Krylov& krylov, Eigen::MatrixXd columns, int count) {
  orthonormalise(krylov.pencil.mass, columns);
  const Eigen::MatrixXd energy =
      columns.transpose() * (krylov.pencil.stiffness.selfadjointView<Eigen::Lower>() * columns);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(energy);
  const Eigen::Index r = krylov.rigid.cols();
  LowestModes result{Eigen::VectorXd::Zero(r + count), Eigen::MatrixXd(columns.rows(), r + count)};
  result.lambda.tail(count) = eigen.eigenvalues().head(count);
  result.shapes << krylov.rigid, columns * eigen.eigenvectors().leftCols(count);
  return result;
}

}  // namespace

LowestModes lowest_modes(const Pencil& pencil, int count, double s) {
  const Eigen::Index space = pencil.mass.rows() - pencil.rigid.cols();
  require(count > 0 && count <= space, "lowest modes: " + std::to_string(count) +
                                           " were asked for, expected 1 to " +
                                           std::to_string(space));
  const Eigen::Index kept = std::min<Eigen::Index>(count + kBlock, space);
  const Eigen::Index most = std::min<Eigen::Index>(space, 12 * kept + 60);
  Krylov krylov(pencil, s, most);
  Dice dice(7);
  Eigen::MatrixXd next = dice.normal(pencil.mass.rows(), std::min(kBlock, most));
  while (true) {
    const Eigen::MatrixXd image = krylov.extend(next);
    const bool full = krylov.size == most;
    if (krylov.size >= kept || full) {
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz(
          krylov.projected.topLeftCorner(krylov.size, krylov.size));
      const Eigen::MatrixXd largest = ritz.eigenvectors().rightCols(std::min(kept, krylov.size));
      const Eigen::MatrixXd last = largest.bottomRows(image.cols()).rightCols(count);
      const Eigen::VectorXd residual =
          (last.transpose() * krylov.outside(image) * last).diagonal().cwiseMax(0.0).cwiseSqrt();
      const Eigen::VectorXd theta = ritz.eigenvalues().tail(count);
      if (krylov.size == space || (residual.array() <= kTolerance * theta.array()).all()) {
        return settled(krylov, krylov.basis.leftCols(krylov.size) * largest, count);
      }
    }
    if (full) throw NumericalFailure("lowest modes: no convergence");
    next = image.leftCols(std::min(image.cols(), most - krylov.size));
  }
}

}  // namespace chladni::simulators
