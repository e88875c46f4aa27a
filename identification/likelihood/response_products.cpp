#include "identification/likelihood/response_products.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <complex>

#include "dense/algebra.h"

namespace chladni::identification {
namespace {

using Complex = std::complex<double>;

constexpr Eigen::Index kAtOnce = 32;  // number of responses summed in one product
constexpr double kLostDigits = 1e-3;  // gap between poles over the distance of the nearest line

enum Kind : Eigen::Index {
  kWeight,
  kErrorReal,
  kErrorImaginary,
  kSlow,
  kDelayReal,
  kDelayImaginary
};

}  // namespace

ResponseProducts::ResponseProducts(const BlockModel& model, const Misfit& misfit,
                                   const Target& target, const Fitted& fitted)
    : model_(model), misfit_(misfit), target_(target), fitted_(fitted) {
  slow_ = target_.x.array().square().inverse();
  list_fractions();
  fill_lines();
  list_near_poles();
}

void ResponseProducts::list_fractions() {
  Eigen::Index parameter = 0;
  std::vector<Complex> poles;
  for (const auto& block : model_.blocks) {
    auto one = block.rigid ? BlockFractions{} : fractions(block);
    const auto n = one.pole.size();
    one.parameter = parameter;
    one.first = rows_;
    parameter += parameter_count(block);
    if (block.rigid) {
      rigid_ = true;
    } else {
      for (Eigen::Index r = 0; r < n; ++r) {
        poles.push_back(one.pole(r));
        plain_.push_back(rows_ + r);
        square_.push_back(rows_ + n + r);
      }
      rows_ += 2 * n;
    }
    blocks_.push_back(std::move(one));
  }
  parameters_ = parameter;
  pole_ = Eigen::Map<const Eigen::VectorXcd>(poles.data(), static_cast<Eigen::Index>(poles.size()));
}

void ResponseProducts::fill_lines() {
  lines_.resize(2 * rows_, target_.line_count());
  for (Eigen::Index k = 0; k < target_.line_count(); ++k) {
    for (Eigen::Index r = 0; r < pole_.size(); ++r) {
      const Complex f = 1.0 / (Complex(0.0, target_.x(k)) - pole_(r));
      const Complex squared = f * f;
      const auto plain = plain_[static_cast<std::size_t>(r)];
      const auto square = square_[static_cast<std::size_t>(r)];
      lines_(plain, k) = f.real();
      lines_(rows_ + plain, k) = f.imag();
      lines_(square, k) = squared.real();
      lines_(rows_ + square, k) = squared.imag();
    }
  }
}

Eigen::VectorXcd ResponseProducts::Sums::complex(Eigen::Index kind, Eigen::Index e) const {
  const auto column = of.col(kind * count + e - begin);
  Eigen::VectorXcd result(column.size() / 2);
  result.real() = column.head(result.size());
  result.imag() = column.tail(result.size());
  return result;
}

Eigen::VectorXcd ResponseProducts::Sums::with(Eigen::Index real, Eigen::Index e) const {
  const auto a = complex(real, e);
  const auto b = complex(real + 1, e);
  Eigen::VectorXcd result(a.size());
  result.real() = a.real() + b.imag();
  result.imag() = b.real() - a.imag();
  return result;
}

ResponseProducts::Sums ResponseProducts::sums(Eigen::Index begin, Eigen::Index end) const {
  const auto lines = target_.line_count();
  const Eigen::Index kinds = fitted_.delay ? 6 : rigid_ ? 4 : 3;
  Sums result{begin, end - begin, Eigen::MatrixXd::Zero(2 * rows_, kinds * (end - begin))};
  Eigen::MatrixXd weights(lines, kinds * result.count);
  for (Eigen::Index e = begin; e < end; ++e) {
    const auto column = [&](Kind kind) { return weights.col(kind * result.count + e - begin); };
    const auto w = target_.squared.col(e);
    column(kWeight) = w;
    column(kErrorReal) = w.cwiseProduct(misfit_.error.col(e).head(lines));
    column(kErrorImaginary) = w.cwiseProduct(misfit_.error.col(e).tail(lines));
    if (kinds > kSlow) column(kSlow) = w.cwiseProduct(slow_);
    if (!fitted_.delay) continue;
    const Eigen::VectorXd wx = w.cwiseProduct(target_.x);  // −s Ĝ
    column(kDelayReal) = wx.cwiseProduct(misfit_.response.col(e).tail(lines));
    column(kDelayImaginary) = -wx.cwiseProduct(misfit_.response.col(e).head(lines));
  }
  dense::add_product(lines_, weights, 1.0, result.of);
  return result;
}

// Σ w² f̄_u f_v for the fractions of all poles and their squares.
void ResponseProducts::fill_pole_pairs(const Eigen::VectorXcd& moment,
                                       Eigen::MatrixXcd& gram) const {
  const auto n = static_cast<std::size_t>(pole_.size());
  for (std::size_t b = 0; b < n; ++b) {
    const Complex m1b = moment(plain_[b]);
    const Complex m2b = moment(square_[b]);
    for (std::size_t a = 0; a <= b; ++a) {
      const Complex m1 = -std::conj(moment(plain_[a]));
      const Complex m2 = std::conj(moment(square_[a]));
      const Complex over = 1.0 / (-std::conj(pole_(static_cast<Eigen::Index>(a))) -
                                  pole_(static_cast<Eigen::Index>(b)));
      const Complex s11 = (m1 - m1b) * over;
      const Complex s21 = (m2 - s11) * over;
      const Complex s12 = (s11 - m2b) * over;
      const Complex s22 = (m2 + m2b - 2.0 * s11) * over * over;
      const auto put = [&](Eigen::Index u, Eigen::Index v, Complex value) {
        gram(u, v) = value;
        gram(v, u) = std::conj(value);
      };
      put(plain_[a], plain_[b], -s11);
      put(plain_[a], square_[b], -s12);
      put(square_[a], plain_[b], s21);
      put(square_[a], square_[b], s22);
    }
  }
}

void ResponseProducts::list_near_poles() {
  const auto n = static_cast<std::size_t>(pole_.size());
  Eigen::VectorXd distance(pole_.size());
  for (Eigen::Index r = 0; r < pole_.size(); ++r) {
    const Eigen::ArrayXcd s = Complex(0.0, 1.0) * target_.x.cast<Complex>().array();
    distance(r) = (s - pole_(r)).abs().minCoeff();
  }
  for (std::size_t b = 0; b < n; ++b) {
    for (std::size_t a = 0; a <= b; ++a) {
      const auto i = static_cast<Eigen::Index>(a);
      const auto j = static_cast<Eigen::Index>(b);
      const double gap = std::abs(std::conj(pole_(i)) + pole_(j));
      if (gap < kLostDigits * std::min(distance(i), distance(j))) near_.emplace_back(a, b);
    }
  }
}

void ResponseProducts::fill_near_poles(Eigen::Index e, Eigen::MatrixXcd& gram) const {
  const auto w = target_.squared.col(e).transpose();
  const auto line = [&](Eigen::Index row) {
    Eigen::RowVectorXcd f(target_.line_count());
    f.real() = lines_.row(row);
    f.imag() = lines_.row(rows_ + row);
    return f;
  };
  for (const auto& [a, b] : near_) {
    for (const auto u : {plain_[a], square_[a]}) {
      const Eigen::RowVectorXcd left = line(u).conjugate().cwiseProduct(w.cast<Complex>());
      for (const auto v : {plain_[b], square_[b]}) {
        gram(u, v) = left.cwiseProduct(line(v)).sum();
        gram(v, u) = std::conj(gram(u, v));
      }
    }
  }
}

// Products without a pole: of 1/s², 1 and the delay with each other and with the error. Only their
// real parts are used.
void ResponseProducts::fill_single_functions(Eigen::Index e, Products& products) const {
  const auto lines = target_.line_count();
  const auto w = target_.squared.col(e).array();
  const auto error = misfit_.error.col(e);
  const Eigen::ArrayXd real = w * error.head(lines).array();
  auto& gram = products.gram;
  const auto put = [&](Eigen::Index u, Eigen::Index v, double value) {
    gram(u, v) = value;
    gram(v, u) = value;
  };
  if (fitted_.residual) {
    put(residual_row(), residual_row(), w.sum());
    products.right(residual_row()) = real.sum();
  }
  if (rigid_) {
    put(rigid_row(), rigid_row(), (w * slow_.array().square()).sum());
    products.right(rigid_row()) = -(real * slow_.array()).sum();
    if (fitted_.residual) put(rigid_row(), residual_row(), -(w * slow_.array()).sum());
  }
  if (!fitted_.delay) return;
  const auto response = misfit_.response.col(e);
  const Eigen::ArrayXd wx = w * target_.x.array();
  const Eigen::ArrayXd late = wx * response.tail(lines).array();  // weighted Re(−s Ĝ)
  const auto row = delay_row();
  put(row, row,
      (wx * target_.x.array() *
       (response.head(lines).array().square() + response.tail(lines).array().square()))
          .sum());
  products.right(row) = (late * error.head(lines).array()).sum() -
                        (wx * response.head(lines).array() * error.tail(lines).array()).sum();
  if (rigid_) put(row, rigid_row(), -(late * slow_.array()).sum());
  if (fitted_.residual) put(row, residual_row(), late.sum());
}

ResponseProducts::Products ResponseProducts::products(Eigen::Index e, const Sums& sums) const {
  const auto n = function_count();
  Products result{Eigen::MatrixXcd::Zero(n, n), Eigen::VectorXcd::Zero(n)};
  const Eigen::VectorXcd moment = sums.complex(kWeight, e);
  fill_pole_pairs(moment, result.gram);
  fill_near_poles(e, result.gram);
  const auto border = [&](Eigen::Index row, const Eigen::VectorXcd& with_fractions) {
    result.gram.col(row).head(rows_) = with_fractions;
    result.gram.row(row).head(rows_) = with_fractions.adjoint();
  };
  if (rigid_) border(rigid_row(), -sums.complex(kSlow, e).conjugate());
  if (fitted_.residual) border(residual_row(), moment.conjugate());
  if (fitted_.delay) border(delay_row(), sums.with(kDelayReal, e));
  result.right.head(rows_) = sums.with(kErrorReal, e);
  fill_single_functions(e, result);
  return result;
}

std::vector<ResponseProducts::Part> ResponseProducts::parts_of(Eigen::Index e) const {
  const auto p = target_.outputs;
  const auto i = e % p;
  const auto j = e / p;
  std::vector<Part> parts;
  for (std::size_t c = 0; c < blocks_.size(); ++c) {
    const auto& block = model_.blocks[c];
    const auto g = block.size();
    Part part{
        block.rigid ? rigid_row() : blocks_[c].first, derivatives(block, blocks_[c], i, j), {}, {}};
    const auto first = blocks_[c].parameter;
    for (Eigen::Index a = 0; a < g; ++a) part.parameter.push_back(first + i + p * a);
    for (Eigen::Index b = 0; b < g; ++b) part.parameter.push_back(first + p * g + b + g * j);
    const auto others = first + g * (p + target_.inputs);
    for (Eigen::Index t = 0; t < part.by.cols() - 2 * g; ++t) part.parameter.push_back(others + t);
    parts.push_back(std::move(part));
  }
  if (fitted_.delay) {
    const auto own = parameters_ + fitted_.delay_index(e, p);
    parts.push_back({delay_row(), SmallComplex::Ones(1, 1), {own}, {}});
  }
  return parts;
}

// The residual of one response affects no other response, so its best value is eliminated here.
void ResponseProducts::add_gradient(const Products& products, double pivot,
                                    std::vector<Part>& parts, NormalEquations& sum) const {
  const double off = fitted_.residual ? products.right(residual_row()).real() : 0.0;
  for (auto& part : parts) {
    const auto rows = part.by.rows();
    const auto half = part.by.adjoint();
    SmallColumn along = half.lazyProduct(products.right.segment(part.row, rows)).real();
    if (pivot > 0.0) {
      part.with_residual =
          half.lazyProduct(products.gram.col(residual_row()).segment(part.row, rows)).real();
      along -= part.with_residual * (off / pivot);
    }
    for (std::size_t t = 0; t < part.parameter.size(); ++t) {
      sum.gradient(part.parameter[t]) += along(static_cast<Eigen::Index>(t));
    }
  }
}

ResponseProducts::SmallReal ResponseProducts::between(const Eigen::MatrixXcd& gram, const Part& c,
                                                      const Part& d) {
  const auto single = [](const Part& one) { return one.by.rows() == 4 && one.by.cols() == 4; };
  if (single(c) && single(d)) {  // the most frequent case
    const Eigen::Matrix4cd half = gram.block<4, 4>(c.row, d.row) * d.by.topLeftCorner<4, 4>();
    return (c.by.topLeftCorner<4, 4>().adjoint() * half).real();
  }
  const SmallComplex half = gram.block(c.row, d.row, c.by.rows(), d.by.rows()).lazyProduct(d.by);
  return c.by.adjoint().lazyProduct(half).real();
}

void ResponseProducts::scatter(Eigen::Index e, const Products& products,
                               NormalEquations& sum) const {
  auto parts = parts_of(e);
  const double pivot =
      fitted_.residual ? products.gram(residual_row(), residual_row()).real() : 0.0;
  add_gradient(products, pivot, parts, sum);
  for (std::size_t d = 0; d < parts.size(); ++d) {
    for (std::size_t c = d; c < parts.size(); ++c) {
      SmallReal square = between(products.gram, parts[c], parts[d]);
      if (pivot > 0.0) {
        square -= parts[c].with_residual.lazyProduct(parts[d].with_residual.transpose()) / pivot;
      }
      for (Eigen::Index t = 0; t < square.cols(); ++t) {
        const auto column = parts[d].parameter[static_cast<std::size_t>(t)];
        for (Eigen::Index r = 0; r < square.rows(); ++r) {
          const auto row = parts[c].parameter[static_cast<std::size_t>(r)];
          if (row >= column) sum.matrix(row, column) += square(r, t);
        }
      }
    }
  }
}

void ResponseProducts::add(Eigen::Index begin, Eigen::Index end, NormalEquations& sum) const {
  for (auto first = begin; first < end; first += kAtOnce) {
    const auto last = std::min(first + kAtOnce, end);
    const auto some = sums(first, last);
    for (auto e = first; e < last; ++e) {
      if (target_.squared.col(e).maxCoeff() > 0.0) scatter(e, products(e, some), sum);
    }
  }
}

}  // namespace chladni::identification
