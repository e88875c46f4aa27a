#include "identification/poles/drift.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identification/constants.h"

namespace chladni::identification {
namespace {

constexpr double kStep = 1e-7;  // relative frequency step for the slopes

// The fit reduced to response e.
ModalFit single(const ModalFit& fit, Eigen::Index e) {
  const auto i = e % fit.model.output_count();
  const auto j = e / fit.model.output_count();
  ModalFit reduced;
  reduced.model = fit.model;
  reduced.model.output_shapes = fit.model.output_shapes.row(i);
  reduced.model.input_shapes = fit.model.input_shapes.col(j);
  reduced.model.residual = Eigen::MatrixXd::Constant(1, 1, fit.model.residual(i, j));
  reduced.delay_s = response_delays(fit)(e);
  if (fit.complex) {
    reduced.complex.emplace();
    reduced.complex->outputs = fit.complex->outputs.row(i);
    reduced.complex->inputs = fit.complex->inputs.col(j);
  }
  return reduced;
}

// Derivative of the model by a relative shift of its resonances: K×pq.
Eigen::MatrixXcd slopes(const ModalFit& fit, const Eigen::VectorXd& frequency_hz) {
  return (responses(fit, frequency_hz * (1.0 - kStep)) -
          responses(fit, frequency_hz * (1.0 + kStep))) /
         (2.0 * kStep);
}

// Adds the shifts that remain in `data`, and sets the deviations.
void add_shifts(const FitData& data, const ModalFit& fit, Drift& drift) {
  const auto slope = slopes(fit, data.frequency_hz);
  const Eigen::MatrixXcd error = data.value - responses(fit, data.frequency_hz);
  const double level = noise_level(fit, data);
  for (Eigen::Index e = 0; e < data.response_count(); ++e) {
    const Eigen::ArrayXd squared = data.weight.col(e).array().square();
    const double information = (slope.col(e).array().abs2() * squared).sum();
    if (!(information > 0.0)) continue;
    const Eigen::ArrayXcd along = slope.col(e).array().conjugate() * error.col(e).array();
    drift.shift(e) += (along.real() * squared).sum() / information;
    drift.deviation(e) = std::sqrt(0.5 * level / information);
  }
}

// Responses of which something was measured.
double told_count(const Drift& drift) {
  return std::max(1.0, static_cast<double>(drift.deviation.array().isFinite().count()));
}

// The shifts about their mean; uncertain ones are shrunk.
Eigen::VectorXd settled(const Drift& drift) {
  const Eigen::ArrayXd information = drift.deviation.array().square().inverse();
  const double mean = (information * drift.shift.array()).sum() / information.sum();
  const Eigen::ArrayXd about =
      (drift.deviation.array().isFinite()).select(drift.shift.array() - mean, 0.0);
  const double square = (about.square() * information).sum() / information.sum();
  const double own = told_count(drift) / information.sum();
  const double scatter = std::max(0.0, square - own);
  return about * scatter /
         (scatter + drift.deviation.array().square()).max(std::numeric_limits<double>::min());
}

// |Ĝ(f / (1 + shift)) − Ĝ(f)| over |Ĝ|, rms over the responses.
double change_by(const FitData& data, const ModalFit& fit, const Eigen::VectorXd& shift) {
  const auto moved = without_drift(data, fit, shift);
  const auto fitted = responses(fit, data.frequency_hz);
  const Eigen::ArrayXXd measured = (data.weight.array() > 0.0).cast<double>();
  double sum = 0.0;
  Eigen::Index count = 0;
  for (Eigen::Index e = 0; e < data.response_count(); ++e) {
    const double size = (fitted.col(e).cwiseAbs2().array() * measured.col(e)).sum();
    if (!(size > 0.0)) continue;
    sum += ((moved.value.col(e) - data.value.col(e)).cwiseAbs2().array() * measured.col(e)).sum() /
           size;
    ++count;
  }
  return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0.0;
}

}  // namespace

bool Drift::matters() const {
  return change > Constants::drift_matters && excess > Constants::no_chance;
}

DriftFit drift_fit(const FitData& data, const Start& start, const FitOptions& options) {
  const auto n = data.response_count();
  Drift result{Eigen::VectorXd::Zero(n),
               Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity()), 0.0, 0.0};
  const auto few = first_fit_options(options);
  auto fit = modal_fit(data, start, few);
  FitData freed = data;
  for (int round = 0; round < Constants::drift_rounds; ++round) {
    const Eigen::VectorXd before = result.shift;
    add_shifts(freed, fit, result);
    result.shift = settled(result);
    freed = without_drift(data, fit, result.shift);
    if ((result.shift - before).norm() <= Constants::drift_settled * result.shift.norm()) break;
    fit = modal_fit(freed, start_at(fit.model), few);
  }
  result.change = change_by(data, fit, result.shift);
  result.excess =
      std::sqrt(result.shift.cwiseQuotient(result.deviation).squaredNorm() / told_count(result));
  return {std::move(result), std::move(fit)};
}

FitData without_drift(const FitData& data, const ModalFit& fit, const Eigen::VectorXd& shift) {
  FitData result = data;
  for (Eigen::Index e = 0; e < data.response_count(); ++e) {
    if (shift(e) == 0.0) continue;
    const auto response = single(fit, e);
    const Eigen::VectorXcd change = responses(response, data.frequency_hz) -
                                    responses(response, data.frequency_hz / (1.0 + shift(e)));
    result.value.col(e) +=
        change.cwiseProduct((data.weight.col(e).array() > 0.0).cast<double>().matrix());
  }
  return result;
}

}  // namespace chladni::identification
