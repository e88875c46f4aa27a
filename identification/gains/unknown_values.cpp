#include "identification/gains/unknown_values.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace chladni::identification {
namespace {

// Replaces each unknown variance by the square of a thousand times the size of its value. This is
// finite and carries no information.
void bound(Eigen::MatrixXd& covariance, const Eigen::VectorXd& size) {
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    if (std::isfinite(covariance(i, i))) continue;
    covariance.row(i).setZero();
    covariance.col(i).setZero();
    covariance(i, i) = std::pow(1e3 * size(i), 2);
  }
}

// Sizes of ω, ζ, L and R (2 + p + q); complex shapes need p + q more.
Eigen::VectorXd sizes(const ModalFit& fit, Eigen::Index m, Eigen::Index count) {
  const auto p = fit.model.output_count();
  const auto q = fit.model.input_count();
  const auto rms = [](const auto& part) {
    return part.norm() / std::sqrt(static_cast<double>(part.size()));
  };
  Eigen::VectorXd size(2 + 2 * (p + q));
  size.setConstant(rms(fit.model.output_shapes.col(m)));
  size(0) = std::max(1.0, 2.0 * std::numbers::pi * fit.model.frequency_hz(m));
  size(1) = 1.0;
  const double input = rms(fit.model.input_shapes.row(m));
  size.segment(2 + p, q).setConstant(input);
  size.tail(q).setConstant(input);
  return size.head(count);
}

// Variances that the fit does not know, of poles and both sides.
void mark_variances(const ModalFit& fit, GainMatch& match) {
  for (std::size_t m = 0; m < std::min(fit.mode_covariance.size(), match.mode_covariance.size());
       ++m) {
    const auto& fitted = fit.mode_covariance[m];
    auto& matched = match.mode_covariance[m];
    if (matched.rows() != fitted.rows()) continue;
    for (Eigen::Index i = 0; i < fitted.rows(); ++i) {
      if (!std::isfinite(fitted(i, i))) {
        matched(i, i) = std::numeric_limits<double>::infinity();
      }
    }
  }
}

}  // namespace

void bound_unknown(ModalFit& fit) {
  const auto r = fit.model.rigid_count;
  for (std::size_t m = 0; m < fit.mode_covariance.size(); ++m) {
    auto& covariance = fit.mode_covariance[m];
    bound(covariance, sizes(fit, static_cast<Eigen::Index>(m), covariance.rows()));
    if (!fit.complex || m >= fit.complex->covariance.size()) continue;
    auto& both = fit.complex->covariance[m];
    bound(both, sizes(fit, static_cast<Eigen::Index>(m), both.rows()));
  }
  const auto rigid = fit.rigid_covariance.rows();
  if (rigid == 0) return;
  const double size = std::max(fit.model.output_shapes.leftCols(r).cwiseAbs().maxCoeff(),
                               fit.model.input_shapes.topRows(r).cwiseAbs().maxCoeff());
  bound(fit.rigid_covariance, Eigen::VectorXd::Constant(rigid, size));
}

void mark_unknown(const ModalFit& fit, Matching& state) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const auto m = fit.model.mode_count();
  mark_variances(fit, state.match);
  if (fit.output_std.cols() != m || fit.input_std.rows() != m) return;
  const auto unknown = [](double deviation) { return !std::isfinite(deviation); };
  auto& match = state.match;
  for (Eigen::Index k = 0; k < m; ++k) {
    for (Eigen::Index i = 0; i < state.p(); ++i) {
      if (unknown(fit.output_std(i, k))) match.deviation(i, k) = kInfinite;
    }
    for (Eigen::Index j = 0; j < state.q(); ++j) {
      if (!unknown(fit.input_std(k, j))) continue;
      match.input_deviation(k, j) = state.at_inputs_std(j, k) = kInfinite;
    }
  }
}

}  // namespace chladni::identification
