#include "identification/field/mode_spread.h"

#include <cmath>

namespace chladni::identification {
namespace {

// The spread of a mode whose covariance the match did not follow: the fit's own, in the scale of
// the match.
ModeSpread fitted_spread(const ModalFit& fit, const Eigen::RowVectorXd& input, Eigen::Index m) {
  const auto p = fit.model.output_count();
  const auto q = fit.model.input_count();
  const auto& all = fit.mode_covariance[static_cast<std::size_t>(m)];
  const auto& fitted = fit.model.input_shapes.row(m);
  const double square = fitted.squaredNorm();
  const double gain = square > 0.0 ? input.dot(fitted) / square : 1.0;
  return {all.topLeftCorner<2, 2>(),
          gain * gain * all.diagonal().tail(q).transpose(),
          gain * all.block(2 + p, 0, q, 2),
          {}};
}

// The relative change of a row of shapes as a whole is Σ w φ δφ / Σ w φ², w the inverse variances:
// the factors of δφ, 0 where a variance is not positive.
Eigen::VectorXd scale_weights(const Eigen::VectorXd& shape, const Eigen::VectorXd& variance) {
  Eigen::VectorXd weights(shape.size());
  double total = 0.0;
  for (Eigen::Index i = 0; i < shape.size(); ++i) {
    const bool tells = std::isfinite(variance(i)) && variance(i) > 0.0;
    weights(i) = tells ? shape(i) / variance(i) : 0.0;
    total += weights(i) * shape(i);
  }
  return total > 0.0 ? Eigen::VectorXd(weights / total) : Eigen::VectorXd::Zero(shape.size());
}

ScaleSpread scale_spread(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& shape,
                         Eigen::Index q) {
  const auto p = shape.size();
  const Eigen::VectorXd weights = scale_weights(shape, covariance.diagonal().segment(2, p));
  std::vector<Eigen::Index> told;
  for (Eigen::Index i = 0; i < p; ++i) {
    if (weights(i) != 0.0) told.push_back(2 + i);
  }
  if (told.empty()) return {};
  Eigen::VectorXd along(std::ssize(told));
  for (std::size_t i = 0; i < told.size(); ++i)
    along(static_cast<Eigen::Index>(i)) = weights(told[i] - 2);
  const double variance = along.dot(covariance(told, told) * along);
  if (!(variance > 0.0) || !std::isfinite(variance)) return {};
  const Eigen::RowVectorXd with = along.transpose() * covariance(told, Eigen::all);
  return {std::sqrt(variance), with.head<2>().transpose(), with.tail(q)};
}

ModeSpread followed_spread(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& shape,
                           int sign, Eigen::Index q) {
  const auto p = shape.size();
  ModeSpread own{covariance.topLeftCorner<2, 2>(), covariance.diagonal().tail(q).transpose(),
                 sign * covariance.block(2 + p, 0, q, 2), scale_spread(covariance, shape, q)};
  own.scale.input *= sign;
  return own;
}

}  // namespace

std::vector<ModeSpread> mode_spreads(const ModalFit& fit, const GainMatch& match) {
  const Eigen::MatrixXd inputs = driving_shapes(match);
  const auto p = fit.model.output_count();
  std::vector<ModeSpread> all;
  for (Eigen::Index m = 0; m < fit.model.mode_count(); ++m) {
    const auto at = static_cast<std::size_t>(m);
    const bool follows = at < match.mode_covariance.size() && match.mode_covariance[at].size() > 0;
    all.push_back(follows ? followed_spread(match.mode_covariance[at], match.shapes.col(m).head(p),
                                            match.modes[at].sign, inputs.cols())
                          : fitted_spread(fit, inputs.row(m), m));
  }
  return all;
}

}  // namespace chladni::identification
