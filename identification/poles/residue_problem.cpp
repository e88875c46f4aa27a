#include "identification/poles/residue_problem.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include "dense/algebra.h"
#include "dense/blas.h"
#include "identification/poles/pole_products.h"

namespace chladni::identification {
namespace {

constexpr double kJitter = 1e-13;  // for products scaled to a unit diagonal
constexpr double kDigits = 1e-12;  // part of the other function's square that rounding may be

// Takes out the functions of a pole that rounding alone is left of: of a pole and its conjugate
// that are nearly one (a damping ratio of 1), the difference; its square may even be negative.
void take_out_rounding(Eigen::Index poles, PoleProducts::Products& products) {
  auto& gram = products.functions;
  for (Eigen::Index u = 0; u < 2 * poles; ++u) {
    const double other = gram(u ^ 1, u ^ 1);
    if (gram(u, u) > kDigits * std::abs(other)) continue;
    gram.row(u).setZero();
    gram.col(u).setZero();
    products.mixed.row(u).setZero();
  }
}

}  // namespace

ResidueProblem::ResidueProblem(const FitData& data, const Eigen::VectorXcd& poles, bool rigid,
                               Damping damping)
    : outputs_(data.outputs),
      inputs_(data.inputs),
      poles_(poles.size()),
      per_pole_(damping == Damping::general ? 2 : 1),
      rigid_(rigid),
      scale_(2.0 * std::numbers::pi * data.frequency_hz(data.line_count() - 1)),
      total_(data.value.cwiseAbs2().cwiseProduct(data.weight.cwiseAbs2()).sum()) {
  const dense::OneBlasThread one_thread;
  const Eigen::VectorXcd scaled = poles / scale_;
  // 1/(s² − 2 Re(p) s + |p|²) = −j(f − f') / (2 Im p).
  factor_ = -2.0 * scale_ * scale_ * scaled.imag();
  PoleProducts products(data, 2.0 * std::numbers::pi / scale_ * data.frequency_hz, rigid);
  products.set_poles(scaled);
  std::vector<Eigen::Index> used;
  for (Eigen::Index u = 0; u < poles_; ++u) {
    if (per_pole_ == 2) used.push_back(2 * u);
    used.push_back(2 * u + 1);
  }
  for (auto u = 2 * poles_; u < products.function_count(); ++u) used.push_back(u);
  for (Eigen::Index e = 0; e < data.response_count(); ++e) {
    auto one = products.of(e, true);
    take_out_rounding(poles_, one);
    const Eigen::VectorXd right = one.mixed.col(2 * poles_);
    responses_.push_back({one.functions(used, used), right(used)});
  }
}

Residues ResidueProblem::residues() const {
  std::vector<Eigen::Index> all(static_cast<std::size_t>(poles_));
  std::iota(all.begin(), all.end(), Eigen::Index{0});
  return residues(all);
}

void ResidueProblem::put(std::size_t response, const std::vector<Eigen::Index>& chosen,
                         const Eigen::VectorXd& c, const Eigen::MatrixXd& inverse,
                         const Eigen::VectorXd& unit, Residues& result) const {
  const auto i = static_cast<Eigen::Index>(response) % outputs_;
  const auto j = static_cast<Eigen::Index>(response) / outputs_;
  for (std::size_t m = 0; m < chosen.size(); ++m) {
    const auto u = per_pole_ * static_cast<Eigen::Index>(m);
    if (per_pole_ == 1) {
      result.of_pole[m](i, j) = factor_(chosen[m]) * unit(u) * c(u);
      result.significance(u) += c(u) * c(u) / inverse(u, u);
    } else {
      result.general[m](i, j) =
          scale_ * std::complex<double>(unit(u) * c(u), unit(u + 1) * c(u + 1));
      const Eigen::Vector2d both = c.segment<2>(u);
      const Eigen::Matrix2d spread = inverse.block<2, 2>(u, u);
      result.significance(static_cast<Eigen::Index>(m)) += both.dot(spread.inverse() * both);
    }
  }
  const auto n = per_pole_ * static_cast<Eigen::Index>(chosen.size());
  result.constant(i, j) = unit(n) * c(n);
  if (!rigid_) return;
  const double factor_rigid = unit(n + 1) * scale_ * scale_;
  result.rigid(i, j) = factor_rigid * c(n + 1);
  if (factor_rigid == 0.0) return;
  result.rigid_worth(i, j) = 1.0 / (inverse(n + 1, n + 1) * factor_rigid * factor_rigid);
}

Residues ResidueProblem::residues(const std::vector<Eigen::Index>& chosen) const {
  std::vector<Eigen::Index> used;
  for (const auto pole : chosen) {
    for (Eigen::Index u = 0; u < per_pole_; ++u) used.push_back(per_pole_ * pole + u);
  }
  used.push_back(per_pole_ * poles_);
  if (rigid_) used.push_back(per_pole_ * poles_ + 1);
  const auto zero = Eigen::MatrixXd::Zero(outputs_, inputs_);
  const bool general = per_pole_ == 2;
  Residues result{
      std::vector<Eigen::MatrixXd>(general ? 0 : chosen.size(), zero),
      std::vector<Eigen::MatrixXcd>(general ? chosen.size() : 0, zero.cast<std::complex<double>>()),
      zero,
      zero,
      zero,
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(chosen.size())),
      total_};
  for (std::size_t e = 0; e < responses_.size(); ++e) {
    if (responses_[e].gram.diagonal().maxCoeff() == 0.0) continue;
    Eigen::MatrixXd a = responses_[e].gram(used, used);
    const Eigen::ArrayXd square = a.diagonal();
    const Eigen::VectorXd unit = (square > 0.0).select(square.max(1e-300).sqrt().inverse(), 0.0);
    a = unit.asDiagonal() * a * unit.asDiagonal();
    a.diagonal().array() += (square > 0.0).select(kJitter, Eigen::ArrayXd::Ones(square.size()));
    const Eigen::LDLT<Eigen::MatrixXd> factor(a);
    const Eigen::VectorXd right = unit.cwiseProduct(responses_[e].right(used));
    const Eigen::VectorXd c = factor.solve(right);
    const Eigen::MatrixXd inverse = dense::inverse_of(factor);
    put(e, chosen, c, inverse, unit, result);
    result.cost -= right.dot(c);
  }
  result.cost = std::max(result.cost, 0.0);
  return result;
}

}  // namespace chladni::identification
