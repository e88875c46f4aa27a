#include "identification/trust.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/text_stream.h"
#include "identification/constants.h"
#include "identification/poles/beyond_lines.h"
#include "identification/trust/outlying.h"
#include "identification/validation.h"

namespace chladni::identification {
namespace {

// Whether the mean square of a residue L_i R_j over its deviation says so. The unit of no channel
// matters to it, nor how the scale is shared by the two sides. What is not measured is left out.
bool is_shape_known(const ModalFit& fit, Eigen::Index m) {
  if (m >= std::ssize(fit.mode_covariance)) return true;  // the fit tells no deviations
  const Eigen::VectorXd outputs = fit.model.output_shapes.col(m);
  const Eigen::VectorXd inputs = fit.model.input_shapes.row(m).transpose();
  const auto p = outputs.size();
  const Eigen::MatrixXd& covariance = fit.mode_covariance[static_cast<std::size_t>(m)];
  double square = 0.0;
  double count = 0.0;
  for (Eigen::Index i = 0; i < p; ++i) {
    for (Eigen::Index j = 0; j < inputs.size(); ++j) {
      if (!std::isfinite(fit.output_std(i, m)) || !std::isfinite(fit.input_std(m, j))) continue;
      const auto left = 2 + i;
      const auto right = 2 + p + j;
      const double variance = inputs(j) * inputs(j) * covariance(left, left) +
                              outputs(i) * outputs(i) * covariance(right, right) +
                              2.0 * outputs(i) * inputs(j) * covariance(left, right);
      square += std::pow(outputs(i) * inputs(j), 2) / std::max(variance, 1e-300);
      count += 1.0;
    }
  }
  return Constants::doubtful * Constants::doubtful * square > count;
}

std::string doubt(const ModalFit& fit, Eigen::Index m) {
  const auto& model = fit.model;
  const auto unsure = [](double deviation, double value) {
    return !(deviation < Constants::doubtful * std::abs(value));
  };
  if (unsure(fit.frequency_std_hz(m), model.frequency_hz(m))) return "its frequency is not known";
  if (unsure(fit.damping_std(m), model.damping_ratio(m))) return "its damping is not known";
  return is_shape_known(fit, m) ? "" : "its shape is not known";
}

// Whether neighbouring lines share what is left: it is no noise.
bool is_smooth(const ModalFit& fit, const FitData& data) {
  const Eigen::MatrixXcd fitted = responses(fit, data.frequency_hz);
  return validation(data, fitted, Eigen::VectorXd(0)).whole.correlation >
         Constants::smooth_remainder;
}

// Where no variance is stated, what is left passes for noise. Modes that explain less than a smooth
// remainder may stand for the same error of the fit as the remainder does.
bool is_less_than_a_smooth_remainder(double explained, const ModalFit& fit, const FitData& data) {
  if (data.noise_known) return false;
  const Eigen::MatrixXcd fitted = responses(fit, data.frequency_hz);
  const double left = (data.value - fitted).cwiseAbs().cwiseProduct(data.weight).squaredNorm();
  return explained < left && is_smooth(fit, data);
}

void look_at_modes(const ModalFit& fit, const FitData& data, Judgement& judgement) {
  double total = 0.0;
  double doubtful = 0.0;
  for (Eigen::Index m = 0; m < fit.model.mode_count(); ++m) {
    const double power = powers_of(fit, m, data).sum();
    const auto why = m < fit.model.rigid_count ? "" : doubt(fit, m);
    if (!why.empty() && is_beyond_lines(data, fit.model.frequency_hz(m))) {
      judgement.beyond_lines.push_back(m);
      continue;
    }
    total += power;
    if (why.empty()) continue;
    judgement.doubtful.push_back({m, why});
    doubtful += power;
  }
  if (total == 0.0) {
    judgement.reasons.emplace_back("no mode within the lines is found");
  } else if (is_less_than_a_smooth_remainder(total, fit, data)) {
    judgement.reasons.emplace_back(
        "the modes within the lines explain less than what is left, which is no noise");
  }
  judgement.doubtful_part = doubtful / std::max(total, 1e-300);
  if (judgement.doubtful_part > Constants::most_doubtful) {
    judgement.reasons.emplace_back("most of what is fitted is in modes that are hardly known");
  }
}

void look_at_what_is_left(const ModalFit& fit, const FitData& data, Judgement& judgement) {
  const Eigen::ArrayXXd measured = (data.weight.array() > 0.0).cast<double>();
  const Eigen::ArrayXXd wrong =
      (data.value - responses(fit, data.frequency_hz)).cwiseAbs2().array() * measured;
  judgement.relative_error = std::sqrt(wrong.sum() / data.value.cwiseAbs2().sum());
  const Eigen::ArrayXXd noise =
      data.weights_are_deviations
          ? Eigen::ArrayXXd(measured / data.weight.array().square().max(1e-300))
          : Eigen::ArrayXXd::Zero(measured.rows(), measured.cols());
  // Each response counts by its own power, whatever its unit.
  const Eigen::ArrayXd power = data.value.cwiseAbs2().colwise().sum().transpose();
  const Eigen::ArrayXd beyond = (wrong - noise).colwise().sum().transpose();
  const auto count = static_cast<double>((power > 0.0).count());
  judgement.unexplained =
      std::max(0.0, (power > 0.0).select(beyond / power.max(1e-300), 0.0).sum() / count);
  if (judgement.unexplained > Constants::most_unexplained) {
    TextWriter text;
    text << "the modes leave " << 100.0 * judgement.unexplained
         << " % of the responses' power unexplained by themselves or noise";
    judgement.reasons.push_back(text.str());
  }
}

// Tries complex shapes where real ones leave more than noise.
void look_at_complex_shapes(const Identified& found, const FitData& data,
                            const std::optional<IdentificationOptions>& again,
                            Judgement& judgement) {
  if (!again || again->fit.damping == Damping::general || !judgement.outlying.empty() ||
      data.response_count() > Constants::most_refitted) {
    return;
  }
  auto options = *again;
  options.fit.damping = Damping::general;
  try {
    const auto other = identified(data, options);
    const ComplexAlternative complex{noise_level(other.fit, data), other.fit.flexible_count(),
                                     found.fit.flexible_count()};
    if (complex.modes <= complex.instead && explain_more(other.fit, found.fit, data)) {
      judgement.with_complex_shapes = complex;
    }
  } catch (const InvalidInput&) {  // they explain nothing: real shapes stay
  } catch (const NumericalFailure&) {
  }
}

// Whether more is left than noise and the error that the model may have. Weights that are no
// deviations tell no noise: there it is what neighbouring lines share.
bool leaves_more(const ModalFit& fit, const FitData& data, const Judgement& judgement) {
  if (data.weights_are_deviations) return judgement.level > Constants::good_level;
  return judgement.relative_error > std::max(data.model_error, Constants::always_off) &&
         is_smooth(fit, data);
}

Trust verdict(const ModalFit& fit, const FitData& data, const Judgement& judgement) {
  if (!judgement.reasons.empty()) return Trust::none;
  // Variances of an unknown number of averages leave up to the good level: ν/(ν−1) of three.
  const bool above = leaves_more(fit, data, judgement);
  if (!data.noise_known) return above ? Trust::systematic : Trust::good;
  if (fit.excess() <= Constants::no_chance) return Trust::to_noise;
  return data.freedom_known || above ? Trust::systematic : Trust::good;
}

}  // namespace

bool explain_more(const ModalFit& complex, const ModalFit& real, const FitData& data) {
  const bool alone_reach_noise = data.noise_known && complex.excess() <= Constants::no_chance &&
                                 real.excess() > Constants::no_chance &&
                                 complex.flexible_count() <= real.flexible_count();
  return alone_reach_noise ||
         noise_level(complex, data) < Constants::complex_pays * noise_level(real, data);
}

const char* word(Trust trust) {
  constexpr std::array kWords{"down to the noise", "good", "systematic errors",
                              "not to be trusted"};
  return kWords[static_cast<std::size_t>(trust)];
}

Judgement judged(const Identified& found, const FitData& data,
                 const std::optional<IdentificationOptions>& again) {
  Judgement judgement;
  judgement.level = noise_level(found.fit, data);
  look_at_what_is_left(found.fit, data, judgement);
  look_at_modes(found.fit, data, judgement);
  look_for_outliers(found, data, again, judgement);
  judgement.trust = verdict(found.fit, data, judgement);
  if (judgement.trust == Trust::systematic || judgement.trust == Trust::none) {
    look_at_complex_shapes(found, data, again, judgement);
  }
  return judgement;
}

}  // namespace chladni::identification
