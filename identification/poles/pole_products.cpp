#include "identification/poles/pole_products.h"

#include <complex>

#include "dense/algebra.h"

namespace chladni::identification {
namespace {

using Complex = std::complex<double>;

// Columns of the weights, per response.
enum Kind : Eigen::Index {
  kPlain,      // w²
  kReal,       // w² Re G
  kImaginary,  // w² Im G
  kSquare,     // w² |G|²
  kPlainSlow,  // w² / x²; the next two likewise
  kRealSlow,
  kImaginarySlow,
  kKinds
};

// Re(t̄ᵤ A tᵥ) for the four entries of A between a pole and its conjugate and another pair.
struct Quad {
  Complex pp, pc, cp, cc;  // p with p, p with conjugate, …
};

void put_real(const Quad& a, Eigen::Index u, Eigen::Index v, Eigen::MatrixXd& result) {
  const Complex j(0.0, 1.0);
  result(2 * u, 2 * v) = (a.pp + a.pc + a.cp + a.cc).real();
  result(2 * u, 2 * v + 1) = (j * (a.pp - a.pc + a.cp - a.cc)).real();
  result(2 * u + 1, 2 * v) = (-j * (a.pp + a.pc - a.cp - a.cc)).real();
  result(2 * u + 1, 2 * v + 1) = (a.pp - a.pc - a.cp + a.cc).real();
}

// Σ W f̄_a f_b for all poles, W = W_r + jW_i: −(conj(M̄(a)) + M(b)) / (ā + b).
void add_pole_pairs(const Eigen::VectorXcd& poles, const Eigen::VectorXcd& m,
                    const Eigen::VectorXcd& conjugate_m, Eigen::MatrixXd& result) {
  const auto n = poles.size();
  for (Eigen::Index v = 0; v < n; ++v) {
    for (Eigen::Index u = 0; u < n; ++u) {
      const auto entry = [&](Complex a, Complex b, Eigen::Index ia, Eigen::Index ib) {
        return -(std::conj(conjugate_m(ia)) + m(ib)) / (std::conj(a) + b);
      };
      const Complex a = poles(u);
      const Complex b = poles(v);
      put_real({entry(a, b, u, v), entry(a, std::conj(b), u, n + v),
                entry(std::conj(a), b, n + u, v), entry(std::conj(a), std::conj(b), n + u, n + v)},
               u, v, result);
    }
  }
}

// Re Σ W ψᵥ for the 2n functions of the poles.
Eigen::VectorXd with_one(const Eigen::VectorXcd& m) {
  const auto n = m.size() / 2;
  const Complex j(0.0, 1.0);
  Eigen::VectorXd result(2 * n);
  for (Eigen::Index v = 0; v < n; ++v) {
    result(2 * v) = (m(v) + m(n + v)).real();
    result(2 * v + 1) = (j * (m(v) - m(n + v))).real();
  }
  return result;
}

}  // namespace

PoleProducts::PoleProducts(const FitData& data, const Eigen::VectorXd& x, bool rigid)
    : responses_(data.response_count()), rigid_(rigid ? 1 : 0), x_(x) {
  const Eigen::Index kinds = rigid ? kKinds : kPlainSlow;
  weights_.setOnes(x.size(), kinds * responses_ + 1);
  const Eigen::ArrayXd slow = x.array().square().inverse();
  for (Eigen::Index e = 0; e < responses_; ++e) {
    const Eigen::ArrayXd w = data.weight.col(e).array().square();
    const Eigen::ArrayXd real = w * data.value.col(e).real().array();
    const Eigen::ArrayXd imaginary = w * data.value.col(e).imag().array();
    const auto column = [&](Kind kind) { return weights_.col(kind * responses_ + e).array(); };
    column(kPlain) = w;
    column(kReal) = real;
    column(kImaginary) = imaginary;
    column(kSquare) = w * data.value.col(e).cwiseAbs2().array();
    if (!rigid) continue;
    column(kPlainSlow) = w * slow;
    column(kRealSlow) = real * slow;
    column(kImaginarySlow) = imaginary * slow;
  }
}

void PoleProducts::set_poles(const Eigen::VectorXcd& poles) {
  poles_ = poles;
  const auto n = poles.size();
  Eigen::MatrixXd fractions(4 * n, x_.size());
  for (Eigen::Index k = 0; k < x_.size(); ++k) {
    for (Eigen::Index u = 0; u < n; ++u) {
      const Complex f = 1.0 / (Complex(0.0, x_(k)) - poles(u));
      const Complex conjugate = 1.0 / (Complex(0.0, x_(k)) - std::conj(poles(u)));
      fractions(u, k) = f.real();
      fractions(n + u, k) = conjugate.real();
      fractions(2 * n + u, k) = f.imag();
      fractions(3 * n + u, k) = conjugate.imag();
    }
  }
  moments_.setZero(4 * n, weights_.cols());
  dense::add_product(fractions, weights_, 1.0, moments_);
}

Eigen::VectorXcd PoleProducts::moment(Eigen::Index kind, Eigen::Index response) const {
  const auto n = 2 * poles_.size();
  const auto column = moments_.col(kind * responses_ + response);
  Eigen::VectorXcd result(n);
  result.real() = column.head(n);
  result.imag() = column.tail(n);
  return result;
}

PoleProducts::Products PoleProducts::of(Eigen::Index e, bool only_functions) const {
  const auto n = 2 * poles_.size();
  const auto all = function_count();
  const auto sum = [&](Kind kind) { return weights_.col(kind * responses_ + e).sum(); };
  Products result{Eigen::MatrixXd(all, all), Eigen::MatrixXd(all, n + 1), {}};
  auto& functions = result.functions;
  const Eigen::VectorXcd plain = moment(kPlain, e);
  add_pole_pairs(poles_, plain, plain, functions);
  functions.col(n).head(n) = with_one(plain);
  functions(n, n) = sum(kPlain);
  const Complex j(0.0, 1.0);
  const Eigen::VectorXcd real = moment(kReal, e);
  const Eigen::VectorXcd imaginary = moment(kImaginary, e);
  const Eigen::VectorXcd m = real + j * imaginary;
  const Eigen::VectorXcd conjugate_m = real - j * imaginary;
  auto& mixed = result.mixed;
  // Re Σ w² G ψ̄ᵤ = Re Σ w² Ḡ ψᵤ.
  mixed.col(n).head(n) = with_one(conjugate_m);
  mixed(n, n) = sum(kReal);
  if (rigid_ > 0) {
    functions.col(n + 1).head(n) = -with_one(moment(kPlainSlow, e));
    functions(n, n + 1) = -sum(kPlainSlow);
    functions(n + 1, n + 1) =
        (weights_.col(kPlainSlow * responses_ + e).array() / x_.array().square()).sum();
    mixed(n + 1, n) = -sum(kRealSlow);
  }
  for (Eigen::Index c = n; c < all; ++c) functions.row(c).head(c) = functions.col(c).head(c);
  if (!only_functions) fill_with_data(e, m, conjugate_m, result);
  return result;
}

void PoleProducts::fill_with_data(Eigen::Index e, const Eigen::VectorXcd& m,
                                  const Eigen::VectorXcd& conjugate_m, Products& result) const {
  const auto n = 2 * poles_.size();
  auto& mixed = result.mixed;
  add_pole_pairs(poles_, m, conjugate_m, mixed);
  mixed.row(n).head(n) = with_one(m).transpose();
  if (rigid_ > 0) {
    const Complex j(0.0, 1.0);
    const Eigen::VectorXcd slow = moment(kRealSlow, e) + j * moment(kImaginarySlow, e);
    mixed.row(n + 1).head(n) = -with_one(slow).transpose();
  }
  result.data.resize(n + 1, n + 1);
  const Eigen::VectorXcd square = moment(kSquare, e);
  add_pole_pairs(poles_, square, square, result.data);
  result.data.col(n).head(n) = with_one(square);
  result.data.row(n).head(n) = result.data.col(n).head(n).transpose();
  result.data(n, n) = weights_.col(kSquare * responses_ + e).sum();
}

Eigen::VectorXd PoleProducts::sums() const {
  const auto n = 2 * poles_.size();
  Eigen::VectorXcd m(n);
  m.real() = moments_.col(moments_.cols() - 1).head(n);
  m.imag() = moments_.col(moments_.cols() - 1).tail(n);
  Eigen::VectorXd result(n + 1);
  result.head(n) = with_one(m);
  result(n) = static_cast<double>(x_.size());
  return result;
}

}  // namespace chladni::identification
