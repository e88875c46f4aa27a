#include "fem/eigen/lanczos.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/interrupt.h"
#include "dense/panel_kernels.h"
#include "fem/eigen/symmetric_product.h"
#include "host/memory.h"
#include "modal/repeated.h"

namespace chladni::fem {
namespace {

using Matrix = Eigen::MatrixXd;

// Vectors v and their products M v.
struct Block {
  Matrix v, mv;
  bool image_fits = false;  // mv is M v but for a share kImageFits of v along the basis
};
constexpr double kImageFits = 1e-13;

// X := X T, in place.
void multiply_right(Matrix& x, const Matrix& t) {
  constexpr Eigen::Index kRows = 512;
  Matrix part;
  for (Eigen::Index i = 0; i < x.rows(); i += kRows) {
    const auto rows = std::min(kRows, x.rows() - i);
    part.noalias() = x.middleRows(i, rows) * t;
    x.middleRows(i, rows).leftCols(t.cols()) = part;
  }
  if (t.cols() < x.cols()) x.conservativeResize(Eigen::NoChange, t.cols());
}

// The Krylov basis V, M-orthonormal. The basis grows by further matrices, so that no vector is ever
// copied.
class Basis {
  struct Part {
    Matrix vectors;
    Eigen::Index size = 0;  // columns in use
    [[nodiscard]] auto used() const { return vectors.leftCols(size); }
  };

 public:
  Basis(const System& system, const Matrix& known, Eigen::Index room)
      : mass_(system.mass), known_(known), rows_(system.mass.rows()) {
    parts_.push_back({Matrix(rows_, room), 0});
  }

  [[nodiscard]] SymmetricProduct& mass() { return mass_; }
  [[nodiscard]] Eigen::Index size() const { return size_; }

  // The product V X.
  [[nodiscard]] Matrix times(const Matrix& x) const {
    Matrix product = Matrix::Zero(rows_, x.cols());
    Eigen::Index row = 0;
    for (const auto& part : parts_) {
      product.noalias() += part.used() * x.middleRows(row, part.size);
      row += part.size;
    }
    return product;
  }

  // Removes from w its part in the span of `known` and the basis; returns the part along the basis.
  // The product of a block lies, but for rounding, along the last two blocks and what is new. So
  // the first pass takes out these two, and the second one all. Further passes follow where the
  // last one has removed more than rounding.
  Matrix orthogonalise(Block& w) {
    constexpr int kMostPasses = 4;
    constexpr double kOnlyRounding = 1e-8;
    Matrix along = Matrix::Zero(size_, w.v.cols());
    for (int pass = 0; pass < kMostPasses; ++pass) {
      if (!w.image_fits) update_image(w);
      const Eigen::RowVectorXd before = w.v.cwiseProduct(w.mv).colwise().sum();
      Eigen::RowVectorXd removed = Eigen::RowVectorXd::Zero(w.v.cols());
      if (known_.cols() > 0) {
        removed += dense::take_out(known_, w.mv, w.v).colwise().squaredNorm();
      }
      const Matrix part = take_out_from(pass == 0 ? size_ - recent_ : 0, w);
      along.bottomRows(part.rows()) += part;
      removed += part.colwise().squaredNorm();
      const double share = std::sqrt((removed.array() / before.array()).maxCoeff());
      // M w is wrong by this share along the basis, to which w is orthogonal.
      w.image_fits = share < kImageFits;
      if (pass > 0 && share < kOnlyRounding) break;
    }
    return along;
  }

  // W = Q R with QᵀMQ = I. Directions that have vanished (relative to `scale`) are left out of Q.
  // One pass loses accuracy by the condition number of WᵀMW, so a second pass follows where this
  // number is large.
  Matrix normalise(Block& w, double scale) {
    Matrix r = Matrix::Identity(w.v.cols(), w.v.cols());
    for (int pass = 0; pass < 2; ++pass) {
      if (pass > 0 || !w.image_fits) update_image(w);
      const Matrix gram = w.v.transpose() * w.mv;
      const Eigen::SelfAdjointEigenSolver<Matrix> solver(Matrix(0.5 * (gram + gram.transpose())));
      const Eigen::VectorXd& d = solver.eigenvalues();
      const double least = pass == 0 ? 1e-28 * scale * scale + 1e-14 * d.maxCoeff() : 0.0;
      const Eigen::Index rank = (d.array() > least).count();
      if (rank == 0) {  // the space is exhausted
        w.v.resize(Eigen::NoChange, 0);
        w.mv.resize(Eigen::NoChange, 0);
        return Matrix::Zero(0, r.cols());
      }
      const Eigen::VectorXd root = d.tail(rank).cwiseSqrt();
      const Matrix u = solver.eigenvectors().rightCols(rank);
      const Matrix turn = u * root.cwiseInverse().asDiagonal();
      multiply_right(w.v, turn);
      multiply_right(w.mv, turn);
      r = root.asDiagonal() * u.transpose() * r;
      if (d(d.size() - rank) > 1e-4 * d.maxCoeff()) break;
    }
    return r;
  }

  void append(const Matrix& block) {
    if (parts_.back().size + block.cols() > parts_.back().vectors.cols()) grow(block.cols());
    auto& part = parts_.back();
    part.vectors.middleCols(part.size, block.cols()) = block;
    part.size += block.cols();
    size_ += block.cols();
    recent_ = last_ + block.cols();
    last_ = block.cols();
  }

 private:
  void update_image(Block& w) {
    w.mv.resize(w.v.rows(), w.v.cols());
    mass_.apply(w.v, w.mv);
    w.image_fits = true;
  }

  // Takes the part along column `first` of the basis and later ones out of w.
  Matrix take_out_from(Eigen::Index first, Block& w) {
    Matrix along = Matrix::Zero(size_ - first, w.v.cols());
    Eigen::Index row = 0;  // first column of the part
    for (const auto& part : parts_) {
      const auto from = std::max<Eigen::Index>(first - row, 0);
      if (from < part.size) {
        const auto columns = part.vectors.middleCols(from, part.size - from);
        along.middleRows(row + from - first, columns.cols()) = dense::take_out(columns, w.mv, w.v);
      }
      row += part.size;
    }
    return along;
  }

  // Adds room beyond the forecast (lanczos_basis_size). The memory is checked first.
  void grow(Eigen::Index least) {
    const Eigen::Index columns = std::max<Eigen::Index>(least, size_ / 4);
    const auto bytes = 8.0 * static_cast<double>(rows_) * static_cast<double>(columns);
    const auto have = static_cast<double>(available_memory());
    if (bytes > have) {
      throw OutOfResources(fmt::format(
          "modes: {} vectors did not do, {} more take {:.3g} GiB and there is {:.3g} GiB; ask for "
          "fewer modes, or use a coarser mesh",
          size_, columns, bytes / (1 << 30), have / (1 << 30)));
    }
    parts_.push_back({Matrix(rows_, columns), 0});
  }

  SymmetricProduct mass_;
  const Matrix& known_;
  Eigen::Index rows_;
  std::vector<Part> parts_;
  Eigen::Index size_ = 0;
  Eigen::Index last_ = 0, recent_ = 0;  // columns of the last block, and of the last two
};

Matrix random_block(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937 generator(seed);
  Matrix block(rows, columns);
  for (Eigen::Index j = 0; j < columns; ++j) {
    for (Eigen::Index i = 0; i < rows; ++i) block(i, j) = double(generator()) / 4294967296.0 - 0.5;
  }
  return block;
}

// Ritz values of the inverted problem, descending, with their error bounds.
struct Ritz {
  Eigen::VectorXd theta;
  Matrix vectors;
  Eigen::VectorXd error;  // per pair: norm of the remainder from the last block

  // Error of λ = 1/θ − s after purification, relative to λ, or to 1e-6 s where λ is smaller. On
  // very soft springs λ is lost in the rounding of θ; `polished` finds this λ later.
  [[nodiscard]] double relative(Eigen::Index i, double s) const {
    const double lambda = std::max(1.0 / theta(i) - s, 1e-6 * s);
    return error(i) / (theta(i) * theta(i) * lambda);
  }
};

Ritz ritz(const Matrix& t, const Matrix& last) {
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(Matrix(0.5 * (t + t.transpose())));
  Ritz r{solver.eigenvalues().reverse(), solver.eigenvectors().rowwise().reverse(), {}};
  r.error = (last * r.vectors.bottomRows(last.cols())).colwise().norm();
  return r;
}

// Whether the iteration is done. The `wanted` largest θ must have converged. The next θ outside
// their cluster must be accurate enough to place a count in the gap below it. `converged` becomes
// the number of converged θ.
bool is_done(const Ritz& r, double s, const LanczosOptions& options, Eigen::Index& converged) {
  converged = 0;
  while (converged < r.theta.size() && r.theta(converged) > 0.0 &&
         r.relative(converged, s) < options.tolerance) {
    ++converged;
  }
  if (converged < options.wanted || converged >= r.theta.size()) return false;
  const auto lambda = [&](Eigen::Index i) { return 1.0 / r.theta(i) - s; };
  for (auto next = static_cast<Eigen::Index>(options.wanted); next < r.theta.size(); ++next) {
    const bool apart = lambda(next) - lambda(next - 1) > 2.0 * modal::kSplitByMesh * lambda(next);
    if (apart && next <= converged) return r.relative(next, s) < 1e-3;
    if (next >= converged) return false;
  }
  return false;
}

// Block steps from one look at the Ritz values to the next. A look costs size³ and a step n · size,
// so in a small system, or for many modes, the steps between must be worth one; the basis then
// grows by a sixteenth more than it must, at most.
int steps_to_next_look(Eigen::Index n, Eigen::Index size, Eigen::Index block) {
  const auto k = static_cast<double>(size);
  const double look = 40.0 * k * k * k;  // operations, those of BLAS 2 counted five times
  const double step = 8.0 * static_cast<double>(n) * k * static_cast<double>(block);
  const double most = std::max(1.0, k / (16.0 * static_cast<double>(block)));
  return static_cast<int>(std::clamp(look / step, 1.0, most));
}

// φ + r/θ: the Ritz vectors after one more application of the operator, mass-normalised.
// r is the remainder from the last block.
Matrix purified(Basis& basis, const Ritz& r, const Matrix& next, const Matrix& last,
                Eigen::Index count) {
  Matrix shapes = basis.times(r.vectors.leftCols(count));
  if (next.cols() > 0) {
    const Matrix tail = last * r.vectors.bottomRows(last.cols()).leftCols(count);
    shapes.noalias() += next * (tail * r.theta.head(count).cwiseInverse().asDiagonal());
  }
  const Matrix image = basis.mass() * shapes;
  for (Eigen::Index i = 0; i < count; ++i)
    shapes.col(i) /= std::sqrt(shapes.col(i).dot(image.col(i)));
  return shapes;
}

// A random block, M-orthonormal and free of `known`.
Block start_block(Basis& basis, const Factorization& factor, Eigen::Index rows,
                  Eigen::Index columns, unsigned seed) {
  Block q;
  q.v = random_block(rows, columns, seed);
  q.mv = basis.mass() * q.v;
  // The operator is applied once first: the start block's part in the highest modes only costs
  // accuracy.
  q.v = factor.solve(q.mv);
  q.image_fits = false;
  basis.orthogonalise(q);
  basis.normalise(q, 0.0);
  if (q.v.cols() == 0 || !q.v.allFinite()) {
    throw NumericalFailure(
        "modes: the squares of the motions are beyond the range of numbers; expected a modulus, a "
        "density and a size of some material in SI units");
  }
  return q;
}

// One block step: q joins the basis and T, `next` is the block after it. Returns R of the
// remainder.
Matrix advanced(Basis& basis, const Factorization& factor, const Block& q, Block& next, Matrix& t) {
  const Eigen::Index before = basis.size();
  basis.append(q.v);
  next.v = factor.solve(q.mv);
  next.image_fits = false;
  const double scale = next.v.norm();
  const Matrix along = basis.orthogonalise(next);
  t.conservativeResize(basis.size(), basis.size());
  t.middleCols(before, q.v.cols()) = along;
  t.middleRows(before, q.v.cols()) = along.transpose();
  return basis.normalise(next, scale / std::sqrt(static_cast<double>(q.v.rows())));
}

}  // namespace

double lanczos_basis_size(int wanted, int block) { return 2.5 * wanted + 12.0 * block; }

LanczosResult lanczos(const System& system, const Factorization& factor, double s,
                      const Eigen::MatrixXd& known, const LanczosOptions& options,
                      const Progress& progress) {
  const auto n = system.mass.rows();
  const Eigen::Index limit =
      std::min<Eigen::Index>(n - known.cols(), 600 + 8 * Eigen::Index{options.wanted});
  const auto room = static_cast<Eigen::Index>(lanczos_basis_size(options.wanted, options.block));
  Basis basis(system, known, std::min<Eigen::Index>(limit + options.block, room));
  Block q =
      start_block(basis, factor, n, std::min<Eigen::Index>(options.block, limit), options.seed);
  LanczosResult result;
  result.solves = static_cast<int>(q.v.cols());

  Matrix t;
  Block next;
  int next_look = 1;
  for (Eigen::Index converged = 0;;) {
    throw_if_interrupted();
    const Matrix last = advanced(basis, factor, q, next, t);
    result.solves += static_cast<int>(q.v.cols());
    ++result.block_steps;
    const bool is_full = next.v.cols() == 0 || basis.size() >= n - known.cols();
    if (result.block_steps < next_look && !is_full && basis.size() < limit) {
      std::swap(q, next);
      continue;
    }
    next_look = result.block_steps + steps_to_next_look(n, basis.size(), q.v.cols());
    const Ritz r = ritz(t, last);
    const bool done = is_done(r, s, options, converged);
    tell(progress, "iterate", std::min(1.0, double(converged) / options.wanted));
    if (!done && is_full) {
      converged = std::min<Eigen::Index>(r.theta.size(), (r.theta.array() > 0.0).count());
    } else if (!done && basis.size() < limit) {
      std::swap(q, next);
      continue;
    } else if (!done) {
      throw NumericalFailure("modes: " + fmt::to_string(converged) + " of " +
                             fmt::to_string(options.wanted) + " modes converged with " +
                             fmt::to_string(basis.size()) + " vectors");
    }
    result.shapes = purified(basis, r, next.v, last, converged);
    result.lambda = r.theta.head(converged).cwiseInverse().array() - s;
    return result;
  }
}

}  // namespace chladni::fem
