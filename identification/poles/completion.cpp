#include "identification/poles/completion.h"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <vector>

#include "base/finite.h"

namespace chladni::identification {
namespace {

constexpr int kSteps = 100;
constexpr double kSettled = 1e-9;     // decrease of the sum in a step, relative
constexpr double kExplained = 1e-24;  // of the squares: rounding alone is left
constexpr double kFirstDamping = 1e-3, kMostDamping = 1e6, kLeastDamping = 1e-12;
constexpr double kFirstPull = 0.3, kPullLeft = 0.2, kLeastPull = 1e-6;  // of the largest value

// A matrix as rows times columns.
template <typename Matrix>
struct Product {
  Matrix rows, columns;  // p×r, r×q
};

// The matrix whose measured entries are known, and how much its sides are pulled to 0.
template <typename Matrix>
struct Aim {
  const Matrix& value;
  const MeasuredResponses& measured;
  double pull = 0.0;
};

template <typename Matrix>
Matrix left_over(const Aim<Matrix>& aim, const Product<Matrix>& product) {
  const Matrix difference = aim.value - product.rows * product.columns;
  return aim.measured.select(difference, Matrix::Zero(difference.rows(), difference.cols()));
}

template <typename Matrix>
double squares_of(const Aim<Matrix>& aim, const Product<Matrix>& product) {
  return left_over(aim, product).squaredNorm() +
         aim.pull * (product.rows.squaredNorm() + product.columns.squaredNorm());
}

// Damped normal equations of a step of Gauss and Newton. Each row has a block of its own, so that
// all rows are eliminated from the equations of the columns.
template <typename Matrix>
class Step {
 public:
  Step(const Aim<Matrix>& aim, const Product<Matrix>& product, double damping)
      : aim_(aim),
        product_(product),
        conjugate_(product.columns.conjugate()),
        error_(left_over(aim, product)),
        diagonal_(aim.pull + damping * mean_diagonal()) {}

  // The product after the step.
  Product<Matrix> taken() const {
    const auto r = product_.columns.rows();
    const auto q = product_.columns.cols();
    Matrix matrix = diagonal_ * Matrix::Identity(r * q, r * q);
    Matrix right = -aim_.pull * product_.columns.reshaped();
    std::vector<Row> rows;
    for (Eigen::Index i = 0; i < product_.rows.rows(); ++i) {
      rows.push_back(row_of(i));
      eliminate(rows.back(), matrix, right);
    }
    const Matrix change = Matrix(Eigen::PartialPivLU<Matrix>(matrix).solve(right)).reshaped(r, q);
    Product<Matrix> next{product_.rows, product_.columns + change};
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto& row = rows[i];
      const Matrix by_columns = (row.own.adjoint() * change(Eigen::all, row.measured)).transpose();
      next.rows.row(static_cast<Eigen::Index>(i)) +=
          (row.alone - row.solved * by_columns).transpose();
    }
    return next;
  }

 private:
  // The equations of row i: A x + B (aᴴ y_j) = right. A is r×r; B has the columns b_j of the
  // measured entries, a is the row itself, and y_j is the change of column j.
  struct Row {
    std::vector<Eigen::Index> measured;  // entries
    Matrix own;                          // r×1: a
    Matrix error, columns;               // of the measured entries: n×1, B
    Matrix alone, solved;                // A⁻¹ right, A⁻¹ B
  };

  double mean_diagonal() const {
    const Eigen::ArrayXXd told = aim_.measured.template cast<double>();
    const double rows =
        (told.rowwise().sum() * product_.rows.rowwise().squaredNorm().array()).sum();
    const double columns =
        (told.colwise().sum() * product_.columns.colwise().squaredNorm().array()).sum();
    return aim_.pull +
           (rows + columns) / static_cast<double>(product_.rows.size() + product_.columns.size());
  }

  Row row_of(Eigen::Index i) const {
    Row row;
    for (Eigen::Index j = 0; j < error_.cols(); ++j) {
      if (aim_.measured(i, j)) row.measured.push_back(j);
    }
    row.own = product_.rows.row(i).adjoint();
    row.error = error_(i, row.measured).transpose();
    row.columns = conjugate_(Eigen::all, row.measured);
    Matrix matrix = row.columns * row.columns.adjoint();
    matrix.diagonal().array() += diagonal_;
    const Eigen::PartialPivLU<Matrix> factor(matrix);
    row.alone =
        factor.solve(row.columns * row.error - aim_.pull * product_.rows.row(i).transpose());
    row.solved = factor.solve(row.columns);
    return row;
  }

  // Adds a row's part to the equations of the columns.
  void eliminate(const Row& row, Matrix& matrix, Matrix& right) const {
    const auto r = row.own.rows();
    const auto n = std::ssize(row.measured);
    const Matrix square = row.own * row.own.adjoint();
    const Matrix left = Matrix::Identity(n, n) - row.columns.adjoint() * row.solved;
    const Matrix rest = row.error - row.columns.adjoint() * row.alone;
    for (Eigen::Index b = 0; b < n; ++b) {
      const auto j = r * row.measured[static_cast<std::size_t>(b)];
      right.middleRows(j, r) += rest(b) * row.own;
      for (Eigen::Index a = 0; a < n; ++a) {
        const auto i = r * row.measured[static_cast<std::size_t>(a)];
        matrix.block(i, j, r, r) += left(a, b) * square;
      }
    }
  }

  const Aim<Matrix>& aim_;
  const Product<Matrix>& product_;
  Matrix conjugate_;  // of the columns
  Matrix error_;
  double diagonal_;
};

// Levenberg and Marquardt.
template <typename Matrix>
void approach(const Aim<Matrix>& aim, Product<Matrix>& best) {
  const double enough = kExplained * aim.value.squaredNorm();
  double sum = squares_of(aim, best);
  double damping = kFirstDamping;
  for (int step = 0; step < kSteps && damping < kMostDamping && sum > enough; ++step) {
    const auto next = Step<Matrix>(aim, best, damping).taken();
    const double after = squares_of(aim, next);
    if (!(after < sum)) {
      damping *= 10.0;
      continue;
    }
    const bool settled = after > (1.0 - kSettled) * sum;
    best = next;
    sum = after;
    damping = std::max(kLeastDamping, 0.1 * damping);
    if (settled) break;
  }
}

// Both sides are first pulled to 0, and less and less: alone, the measured entries also draw the
// descent into valleys where the sides grow without end (the path of nuclear norms; Mazumder,
// Hastie and Tibshirani 2010).
template <typename Matrix>
Matrix completed_part(const Matrix& value, const MeasuredResponses& measured, Eigen::Index rank) {
  const Matrix from = measured.select(value, Matrix::Zero(value.rows(), value.cols()));
  const Eigen::JacobiSVD<Matrix> svd(from, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const auto size = std::min(rank, svd.singularValues().size());
  const Eigen::VectorXd root = svd.singularValues().head(size).cwiseSqrt();
  const double largest = svd.singularValues()(0);
  Product<Matrix> product{svd.matrixU().leftCols(size) * root.asDiagonal(),
                          root.asDiagonal() * svd.matrixV().leftCols(size).adjoint()};
  for (double pull = kFirstPull; pull > kLeastPull; pull *= kPullLeft) {
    approach<Matrix>({from, measured, pull * largest}, product);
  }
  approach<Matrix>({from, measured, 0.0}, product);
  return measured.select(value, product.rows * product.columns);
}

template <typename Matrix>
Matrix completed_of(const Matrix& value, const MeasuredResponses& measured, Eigen::Index rank) {
  if (measured.all() || rank == 0) return value;
  Matrix result = finite(value, "residue");
  for (const auto& part : connected_channels(measured)) {
    const MeasuredResponses own = measured(part.outputs, part.inputs);
    if (own.all()) continue;
    const Matrix from = value(part.outputs, part.inputs);
    if (own.rows() >= own.cols()) {  // the longer side is the one that is eliminated
      result(part.outputs, part.inputs) = completed_part<Matrix>(from, own, rank);
    } else {
      result(part.outputs, part.inputs) =
          completed_part<Matrix>(from.transpose(), own.transpose(), rank).transpose();
    }
  }
  return result;
}

}  // namespace

MeasuredResponses measured_responses(const Eigen::MatrixXd& weight, Eigen::Index outputs) {
  const Eigen::RowVectorXd sum = weight.colwise().sum();
  return sum.reshaped(outputs, sum.size() / outputs).array() > 0.0;
}

std::vector<ConnectedChannels> connected_channels(const MeasuredResponses& measured) {
  const auto p = measured.rows();
  const auto q = measured.cols();
  // Each channel takes the least number of those that it is connected with.
  Eigen::ArrayX<Eigen::Index> number = Eigen::ArrayX<Eigen::Index>::LinSpaced(p + q, 0, p + q - 1);
  for (bool any = true; any;) {
    any = false;
    for (Eigen::Index j = 0; j < q; ++j) {
      for (Eigen::Index i = 0; i < p; ++i) {
        if (!measured(i, j) || number(i) == number(p + j)) continue;
        number(i) = number(p + j) = std::min(number(i), number(p + j));
        any = true;
      }
    }
  }
  std::vector<ConnectedChannels> parts;
  for (Eigen::Index first = 0; first < p; ++first) {
    ConnectedChannels part;
    for (Eigen::Index i = 0; i < p; ++i) {
      if (number(i) == first) part.outputs.push_back(i);
    }
    for (Eigen::Index j = 0; j < q; ++j) {
      if (number(p + j) == first) part.inputs.push_back(j);
    }
    if (!part.outputs.empty() && !part.inputs.empty()) parts.push_back(std::move(part));
  }
  return parts;
}

Eigen::MatrixXd completed(const Eigen::MatrixXd& value, const MeasuredResponses& measured,
                          Eigen::Index rank) {
  return completed_of(value, measured, rank);
}

Eigen::MatrixXcd completed(const Eigen::MatrixXcd& value, const MeasuredResponses& measured,
                           Eigen::Index rank) {
  return completed_of(value, measured, rank);
}

}  // namespace chladni::identification
