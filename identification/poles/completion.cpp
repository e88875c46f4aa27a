#include "identification/poles/completion.h"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>

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

// Normal equations for changes of the rows, then of the columns.
template <typename Matrix>
struct Equations {
  Matrix matrix, right;
};

template <typename Matrix>
Equations<Matrix> equations(const Aim<Matrix>& aim, const Product<Matrix>& product) {
  const auto r = product.columns.rows();
  const auto p = product.rows.rows();
  const auto n = r * (p + product.columns.cols());
  const Matrix error = left_over(aim, product);
  Equations<Matrix> result{aim.pull * Matrix::Identity(n, n), Matrix::Zero(n, 1)};
  result.right << product.rows.transpose().reshaped(), product.columns.reshaped();
  result.right *= -aim.pull;
  for (Eigen::Index j = 0; j < error.cols(); ++j) {
    const Matrix by_row = product.columns.col(j).conjugate();
    for (Eigen::Index i = 0; i < error.rows(); ++i) {
      if (!aim.measured(i, j)) continue;
      const Matrix by_column = product.rows.row(i).adjoint();
      const auto own = r * i;
      const auto other = r * (p + j);
      result.matrix.block(own, own, r, r) += by_row * by_row.adjoint();
      result.matrix.block(other, other, r, r) += by_column * by_column.adjoint();
      result.matrix.block(own, other, r, r) += by_row * by_column.adjoint();
      result.matrix.block(other, own, r, r) += by_column * by_row.adjoint();
      result.right.middleRows(own, r) += error(i, j) * by_row;
      result.right.middleRows(other, r) += error(i, j) * by_column;
    }
  }
  return result;
}

// The product after a damped step of Gauss and Newton.
template <typename Matrix>
Product<Matrix> stepped(const Product<Matrix>& product, Equations<Matrix> all, double damping) {
  const auto r = product.columns.rows();
  const auto p = product.rows.rows();
  const auto q = product.columns.cols();
  const double mean = all.matrix.diagonal().real().mean();
  all.matrix.diagonal().array() += damping * mean;
  const Matrix step = all.matrix.ldlt().solve(all.right);
  return {product.rows + step.topRows(r * p).reshaped(r, p).transpose(),
          product.columns + step.bottomRows(r * q).reshaped(r, q)};
}

// Levenberg and Marquardt.
template <typename Matrix>
void approach(const Aim<Matrix>& aim, Product<Matrix>& best) {
  const double enough = kExplained * aim.value.squaredNorm();
  double sum = squares_of(aim, best);
  double damping = kFirstDamping;
  for (int step = 0; step < kSteps && damping < kMostDamping && sum > enough; ++step) {
    const auto next = stepped(best, equations(aim, best), damping);
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
    result(part.outputs, part.inputs) =
        completed_part<Matrix>(value(part.outputs, part.inputs), own, rank);
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
