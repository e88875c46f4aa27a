#include "identification/fraction/fraction_equations.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "host/parallel.h"

namespace chladni::identification {

namespace {

constexpr Eigen::Index kLinesAtOnce = 64;

}  // namespace

PolynomialBasis orthonormal_basis(const Eigen::VectorXd& x, const Eigen::VectorXd& weight,
                                  Eigen::Index degree) {
  PolynomialBasis basis;
  basis.recurrence.resize(degree);
  basis.first = 1.0 / weight.norm();
  // φ_k(jx) is j^k times these real values.
  Eigen::VectorXd last = Eigen::VectorXd::Zero(x.size());
  Eigen::VectorXd now = Eigen::VectorXd::Constant(x.size(), basis.first);
  double gamma = 0.0;
  for (Eigen::Index k = 0; k < degree; ++k) {
    Eigen::VectorXd next = x.cwiseProduct(now) - gamma * last;
    gamma = next.cwiseProduct(weight).norm();
    basis.recurrence(k) = gamma;
    last = now;
    now = next / gamma;
  }
  return basis;
}

FractionEquations::FractionEquations(const FitData& data,
                                     const std::vector<Eigen::MatrixXcd>& divided,
                                     const Eigen::MatrixXcd& values,
                                     const Eigen::MatrixXcd& d_basis,
                                     const Eigen::MatrixXcd& n_basis)
    : data_(data),
      divided_(divided),
      values_(values),
      d_basis_(d_basis),
      n_basis_(n_basis),
      outputs_(data.outputs),
      inputs_(data.inputs),
      d_count_(data.outputs * data.outputs * (d_basis.cols() - 1)),
      n_count_(data.outputs * n_basis.cols()),
      gram_(static_cast<std::size_t>(data.inputs)) {
  parallel_ranges(gram_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) gram_[j] = gram(static_cast<Eigen::Index>(j));
  });
}

Eigen::MatrixXcd FractionEquations::weighted(Eigen::Index line, Eigen::Index input) const {
  return data_.weight.row(line).segment(input * outputs_, outputs_).transpose().asDiagonal() *
         divided_[static_cast<std::size_t>(line)];
}

Eigen::MatrixXd FractionEquations::gram(Eigen::Index input) const {
  const auto p = outputs_;
  const auto d = d_basis_.cols() - 1;
  const auto n = n_basis_.cols();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(d_count_ + n_count_, d_count_ + n_count_);
  Eigen::MatrixXd rows(d_count_ + n_count_, 2 * p * kLinesAtOnce);  // transposed
  for (Eigen::Index begin = 0; begin < data_.line_count(); begin += kLinesAtOnce) {
    const auto lines = std::min(kLinesAtOnce, data_.line_count() - begin);
    for (Eigen::Index l = 0; l < lines; ++l) {
      const auto k = begin + l;
      const Eigen::MatrixXcd m = weighted(k, input).transpose();
      const auto put = [&](Eigen::Index at, std::complex<double> factor) {
        rows.block(at, 2 * p * l, p, p) = (factor * m).real();
        rows.block(at, 2 * p * l + p, p, p) = (factor * m).imag();
      };
      for (Eigen::Index a = 0; a < d; ++a) {
        for (Eigen::Index c = 0; c < p; ++c) {
          put((a * p + c) * p, d_basis_(k, a) * values_(k, c + p * input));
        }
      }
      for (Eigen::Index a = 0; a < n; ++a) put(d_count_ + a * p, -n_basis_(k, a));
    }
    sum.selfadjointView<Eigen::Lower>().rankUpdate(rows.leftCols(2 * p * lines));
  }
  return sum;
}

Eigen::MatrixXd FractionEquations::denominator(const Eigen::VectorXd& coefficients,
                                               Eigen::Index a) const {
  return coefficients.segment(a * outputs_ * outputs_, outputs_ * outputs_)
      .reshaped(outputs_, outputs_);
}

Eigen::MatrixXd FractionEquations::numerator(const Eigen::VectorXd& coefficients,
                                             Eigen::Index a) const {
  Eigen::MatrixXd one(outputs_, inputs_);
  for (Eigen::Index j = 0; j < inputs_; ++j) {
    one.col(j) = coefficients.segment(d_count_ + j * n_count_ + a * outputs_, outputs_);
  }
  return one;
}

Eigen::MatrixXcd FractionEquations::errors(const Eigen::VectorXd& coefficients,
                                           bool leading) const {
  const auto p = outputs_;
  const auto d = d_basis_.cols() - 1;
  std::vector<Eigen::MatrixXd> of_d;
  std::vector<Eigen::MatrixXd> of_n;
  for (Eigen::Index a = 0; a < d; ++a) of_d.push_back(denominator(coefficients, a));
  for (Eigen::Index a = 0; a < n_basis_.cols(); ++a) of_n.push_back(numerator(coefficients, a));
  Eigen::MatrixXcd all(data_.line_count(), p * inputs_);
  Eigen::MatrixXcd denominator_at(p, p);
  Eigen::MatrixXcd equation(p, inputs_);
  for (Eigen::Index k = 0; k < data_.line_count(); ++k) {
    denominator_at.setZero();
    if (leading) denominator_at.diagonal().setConstant(d_basis_(k, d));
    for (Eigen::Index a = 0; a < d; ++a) {
      denominator_at += d_basis_(k, a) * of_d[static_cast<std::size_t>(a)];
    }
    equation = denominator_at * values_.row(k).reshaped(p, inputs_);
    for (Eigen::Index a = 0; a < n_basis_.cols(); ++a) {
      equation -= n_basis_(k, a) * of_n[static_cast<std::size_t>(a)];
    }
    equation = (divided_[static_cast<std::size_t>(k)] * equation).eval();
    all.row(k) = equation.reshaped().transpose().cwiseProduct(data_.weight.row(k));
  }
  return all;
}

Eigen::VectorXd FractionEquations::gradient(const Eigen::MatrixXcd& errors) const {
  const auto p = outputs_;
  const auto d = d_basis_.cols() - 1;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(count());
  for (Eigen::Index k = 0; k < data_.line_count(); ++k) {
    const Eigen::RowVectorXcd weighted_errors = errors.row(k).cwiseProduct(data_.weight.row(k));
    const Eigen::MatrixXcd back =
        divided_[static_cast<std::size_t>(k)].adjoint() * weighted_errors.reshaped(p, inputs_);
    const Eigen::MatrixXcd cross = back * values_.row(k).reshaped(p, inputs_).adjoint();
    for (Eigen::Index a = 0; a < d; ++a) {
      sum.segment(a * p * p, p * p) += (std::conj(d_basis_(k, a)) * cross).real().reshaped();
    }
    for (Eigen::Index a = 0; a < n_basis_.cols(); ++a) {
      const Eigen::MatrixXd part = (std::conj(n_basis_(k, a)) * back).real();
      for (Eigen::Index j = 0; j < inputs_; ++j) {
        sum.segment(d_count_ + j * n_count_ + a * p, p) -= part.col(j);
      }
    }
  }
  return sum;
}

Eigen::VectorXd FractionEquations::step(const Eigen::VectorXd& gradient, double damping) const {
  // Each column of N couples only to D: the Schur complement eliminates it.
  Eigen::MatrixXd reduced = Eigen::MatrixXd::Zero(d_count_, d_count_);
  Eigen::VectorXd right = -gradient.head(d_count_);
  for (const auto& one : gram_) reduced += one.topLeftCorner(d_count_, d_count_);
  reduced = reduced.selfadjointView<Eigen::Lower>().toDenseMatrix().eval();
  reduced.diagonal() *= 1.0 + damping;
  std::vector<Eigen::LLT<Eigen::MatrixXd>> factors;
  for (std::size_t j = 0; j < gram_.size(); ++j) {
    Eigen::MatrixXd own = gram_[j].bottomRightCorner(n_count_, n_count_);
    // As small as rounding: an unmeasured column must not stop the others.
    const double least = 1e-15 * std::max(own.diagonal().maxCoeff(), 1e-300);
    own.diagonal() = (1.0 + damping) * own.diagonal().array() + least;
    factors.emplace_back(own);
    const auto coupling = gram_[j].bottomLeftCorner(n_count_, d_count_);
    const Eigen::MatrixXd solved = factors.back().solve(coupling);
    reduced.noalias() -= coupling.transpose() * solved;
    right += solved.transpose() *
             gradient.segment(d_count_ + static_cast<Eigen::Index>(j) * n_count_, n_count_);
  }
  const Eigen::VectorXd scale = reduced.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * reduced * scale.asDiagonal();
  Eigen::VectorXd move(count());
  move.head(d_count_) =
      scale.cwiseProduct(scaled.ldlt().solve(Eigen::VectorXd(scale.cwiseProduct(right))));
  for (std::size_t j = 0; j < gram_.size(); ++j) {
    const auto at = d_count_ + static_cast<Eigen::Index>(j) * n_count_;
    move.segment(at, n_count_) =
        -factors[j].solve(gradient.segment(at, n_count_) +
                          gram_[j].bottomLeftCorner(n_count_, d_count_) * move.head(d_count_));
  }
  return move;
}

}  // namespace chladni::identification
