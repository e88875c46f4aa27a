#include "identification/poles/denominator.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <complex>
#include <limits>
#include <vector>

#include "host/parallel.h"

namespace chladni::identification {
namespace {

using Complex = std::complex<double>;

constexpr double kDiagonalJitter = 1e-13;  // for products scaled to a unit diagonal
constexpr double kRounding = 0.1;          // largest part of `left`
constexpr std::size_t kShares = 8;         // parts of the responses for the threads

// Sums over the responses. The shares do not depend on the threads and are added in order, so any
// number of cores gives the same bits.
template <class Add>
DenominatorProducts sum_of(Eigen::Index responses, Eigen::Index unknowns, const Add& add) {
  const auto count = static_cast<std::size_t>(responses);
  const auto parts = std::min(count, kShares);
  const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(unknowns, unknowns);
  std::vector<DenominatorProducts> sums(parts, {zero, zero});
  parallel_ranges(parts, [&](std::size_t begin, std::size_t end) {
    for (std::size_t part = begin; part < end; ++part) {
      for (std::size_t e = part * count / parts; e < (part + 1) * count / parts; ++e) {
        add(static_cast<Eigen::Index>(e), sums[part]);
      }
    }
  });
  for (std::size_t part = 1; part < parts; ++part) {
    sums[0].left += sums[part].left;
    sums[0].rounding += sums[part].rounding;
  }
  return sums[0];
}

// Subtracts Mᵀ A⁻¹ M, with A first scaled to a unit diagonal. With X = A⁻¹ M, an error ε of A (the
// jitter included) changes the result by Xᵀ ε X.
void eliminate(Eigen::MatrixXd a, Eigen::MatrixXd m, DenominatorProducts& result) {
  const Eigen::VectorXd scale = a.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  a = scale.asDiagonal() * a * scale.asDiagonal();
  a.diagonal().array() += kDiagonalJitter;
  m = scale.asDiagonal() * m;
  const Eigen::MatrixXd x = Eigen::LDLT<Eigen::MatrixXd>(a).solve(m);
  const auto size = static_cast<double>(a.rows());
  const double error = kDiagonalJitter + size * std::numeric_limits<double>::epsilon();
  result.left.noalias() -= m.transpose() * x;
  result.rounding.noalias() += error * x.transpose() * x;
}

// Real parts of the functions above the imaginary parts, 2K×(2n+1).
Eigen::MatrixXd functions_of(const Eigen::VectorXd& x, const Eigen::VectorXcd& poles) {
  const Eigen::Index lines = x.size();
  Eigen::MatrixXcd values(lines, 2 * poles.size() + 1);
  for (Eigen::Index u = 0; u < poles.size(); ++u) {
    for (Eigen::Index k = 0; k < lines; ++k) {
      const Complex s(0.0, x(k));
      const Complex own = 1.0 / (s - poles(u));
      const Complex conjugate = 1.0 / (s - std::conj(poles(u)));
      values(k, 2 * u) = own + conjugate;
      values(k, 2 * u + 1) = Complex(0.0, 1.0) * (own - conjugate);
    }
  }
  values.rightCols(1).setOnes();
  Eigen::MatrixXd result(2 * lines, values.cols());
  result << values.real(), values.imag();
  return result;
}

// W Φ and −W G Ψ of one response side by side; if rigid-body modes are fitted, 1/s² belongs to Φ.
Eigen::MatrixXd rows_of(const FitData& data, Eigen::Index response, const Eigen::VectorXd& x,
                        const Eigen::MatrixXd& functions, bool rigid) {
  const Eigen::Index lines = x.size();
  const Eigen::Index count = functions.cols();
  const Eigen::Index extra = rigid ? 1 : 0;
  const auto w = data.weight.col(response).asDiagonal();
  const auto real = functions.topRows(lines);
  const auto imaginary = functions.bottomRows(lines);
  const Eigen::VectorXd g = data.value.col(response).real();
  const Eigen::VectorXd h = data.value.col(response).imag();
  Eigen::MatrixXd rows(2 * lines, 2 * count + extra);
  rows.topLeftCorner(lines, count) = w * real;
  rows.bottomLeftCorner(lines, count) = w * imaginary;
  if (rigid) {
    rows.col(count).head(lines) = -(w * x.array().square().inverse().matrix());
    rows.col(count).tail(lines).setZero();
  }
  rows.topRightCorner(lines, count) = w * (h.asDiagonal() * imaginary - g.asDiagonal() * real);
  rows.bottomRightCorner(lines, count) =
      -(w * (g.asDiagonal() * imaginary + h.asDiagonal() * real));
  return rows;
}

}  // namespace

DenominatorProducts denominator_by_sums(const PoleProducts& products) {
  const auto add = [&](Eigen::Index response, DenominatorProducts& result) {
    const auto one = products.of(response);
    if (one.functions.diagonal().maxCoeff() == 0.0) return;
    result.left += one.data;
    eliminate(one.functions, one.mixed, result);
  };
  return sum_of(products.response_count(), products.denominator_count(), add);
}

DenominatorProducts denominator_by_rows(const FitData& data, const Eigen::VectorXd& x,
                                        const Eigen::VectorXcd& poles, bool rigid) {
  const Eigen::MatrixXd functions = functions_of(x, poles);
  const Eigen::Index count = functions.cols();
  const auto add = [&](Eigen::Index response, DenominatorProducts& result) {
    if (data.weight.col(response).maxCoeff() == 0.0) return;
    Eigen::MatrixXd rows = rows_of(data, response, x, functions, rigid);
    const Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> factor(rows);
    const auto before = rows.cols() - count;
    const Eigen::MatrixXd left =
        rows.block(before, before, count, count).triangularView<Eigen::Upper>();
    result.left.noalias() += left.transpose() * left;
  };
  return sum_of(data.response_count(), count, add);
}

bool Denominator::sound() const {
  return coefficient.allFinite() && left > 0.0 && rounding <= kRounding * left;
}

Denominator least_denominator(const DenominatorProducts& products, const Eigen::VectorXd& sums) {
  const auto& s = products.left;
  const Eigen::VectorXd scale = s.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = scale.asDiagonal() * s * scale.asDiagonal();
  scaled.diagonal().array() += kDiagonalJitter;
  Eigen::VectorXd c =
      Eigen::LDLT<Eigen::MatrixXd>(scaled).solve(Eigen::VectorXd(scale.cwiseProduct(sums)));
  c = scale.cwiseProduct(c);
  c *= sums(sums.size() - 1) / sums.dot(c);
  return {c, c.dot(s * c), c.dot(products.rounding * c)};
}

}  // namespace chladni::identification
