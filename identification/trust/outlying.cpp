#include "identification/trust/outlying.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/text_stream.h"
#include "base/upper_median.h"
#include "identification/constants.h"

namespace chladni::identification {
namespace {

constexpr double kMedianPower = 0.6931;  // of an exponential number of mean 1

// Degrees of freedom of the variances; 0: exact. Where they are not stated, what a good fit leaves
// tells them: ν/(ν−1).
double freedom(const FitData& data, double level) {
  if (!data.noise_known) return 0.0;
  if (data.freedom_known) return data.noise_freedom;
  return level > 1.0 && level <= Constants::good_level ? level / (level - 1.0) : 0.0;
}

// The |w n| that noise alone exceeds once in a million records.
double largest_of_noise(const FitData& data, double level) {
  const double numbers = std::max(1.0, 0.5 * static_cast<double>(data.measured_count()));
  const double v = freedom(data, level);
  const double rare = std::log(numbers / Constants::false_alarm);
  // P(F > t) is (1 + t/ν)^−ν with 2 and 2ν degrees of freedom; an exponential number has e^−t.
  return std::sqrt(v > 0.0 ? v * std::expm1(rare / v) : rare);
}

double median(std::vector<double>& values) { return values.empty() ? 0.0 : upper_median(values); }

// Median of the measured values among ±Constants::outlier_reach lines, without those within `gap`
// of line k.
double median_beside(const Eigen::VectorXd& values, const Eigen::VectorXd& weight, Eigen::Index k,
                     Eigen::Index gap) {
  std::vector<double> beside;
  const auto last = std::min(values.size() - 1, k + Constants::outlier_reach);
  for (auto i = std::max<Eigen::Index>(0, k - Constants::outlier_reach); i <= last; ++i) {
    if (std::abs(i - k) > gap && weight(i) > 0.0) beside.push_back(values(i));
  }
  return median(beside);
}

// Whether numbers of mean 1 spread as noise does. The test ignores the largest hundredth: outliers
// are fewer than that, resonances that the model does not explain are more.
bool is_noise(std::vector<double>& powers) {
  if (powers.empty()) return true;
  const auto high = powers.begin() + std::ssize(powers) * 99 / 100;
  std::nth_element(powers.begin(), high, powers.end());
  return *high < Constants::noise_tail && median(powers) < Constants::noise_median * kMedianPower;
}

// |G − Ĝ| in deviations of the noise; where noise does not explain the residual, of
// the model as well.
Eigen::VectorXd residuals(const FitData& data, const Eigen::VectorXcd& fitted, Eigen::Index e) {
  const auto lines = data.line_count();
  const Eigen::ArrayXd weight = data.weight.col(e).array();
  const Eigen::ArrayXd wrong = (data.value.col(e) - fitted).cwiseAbs().array();
  const Eigen::ArrayXd size = fitted.cwiseAbs().array();
  std::vector<double> powers;
  for (Eigen::Index k = 0; k < lines; ++k) {
    if (weight(k) > 0.0) powers.push_back(std::pow(weight(k) * wrong(k), 2));
  }
  const bool explained = data.noise_stated && is_noise(powers);
  std::vector<double> parts;
  for (Eigen::Index k = 0; k < lines && !explained; ++k) {
    if (weight(k) > 0.0 && size(k) > 0.0) {
      const double beyond = std::pow(wrong(k), 2) - std::pow(weight(k), -2);
      parts.push_back(std::max(0.0, beyond) / std::pow(size(k), 2));
    }
  }
  const double relative =
      std::max(median(parts) / kMedianPower, Constants::always_off * Constants::always_off);
  Eigen::VectorXd result = Eigen::VectorXd::Zero(lines);
  for (Eigen::Index k = 0; k < lines; ++k) {
    if (!(weight(k) > 0.0)) continue;
    double square = std::pow(weight(k), -2) + relative * size(k) * size(k);
    // Allows for resonances that drift or that are narrower than the distance of the lines.
    const double below = k > 0 ? std::abs(fitted(k) - fitted(k - 1)) : 0.0;
    const double above = k + 1 < lines ? std::abs(fitted(k + 1) - fitted(k)) : 0.0;
    const double steep = (explained ? Constants::steep_off : 1.0) * std::max(below, above);
    square += steep * steep;
    result(k) = wrong(k) / std::sqrt(square);
  }
  return result;
}

std::vector<OutlyingValue> outlying_of(const FitData& data, const ModalFit& fit) {
  const Eigen::MatrixXcd fitted = responses(fit, data.frequency_hz);
  const double least = largest_of_noise(data, noise_level(fit, data));
  std::vector<OutlyingValue> found;
  for (Eigen::Index e = 0; e < data.response_count(); ++e) {
    const auto residual = residuals(data, fitted.col(e), e);
    for (Eigen::Index k = 0; k < residual.size(); ++k) {
      if (!(residual(k) > least)) continue;
      const double beside = median_beside(residual, data.weight.col(e), k, 0);
      if (residual(k) > Constants::beside_neighbours * beside)
        found.push_back({k, e, residual(k), beside});
    }
  }
  return found;
}

// Values where the data jump far more than at the lines nearby.
std::vector<OutlyingValue> jumps_of(const FitData& data) {
  std::vector<OutlyingValue> found;
  for (Eigen::Index e = 0; e < data.response_count(); ++e) {
    const auto value = data.value.col(e);
    const auto lines = value.size();
    Eigen::VectorXd jump = Eigen::VectorXd::Zero(lines);
    for (Eigen::Index k = 0; k < lines; ++k) {
      const auto below = value(k > 0 ? k - 1 : std::min<Eigen::Index>(2, lines - 1));
      const auto above = value(k + 1 < lines ? k + 1 : std::max<Eigen::Index>(0, lines - 3));
      jump(k) = std::abs(value(k) - 0.5 * (below + above));
    }
    for (Eigen::Index k = 0; k < lines; ++k) {
      if (!(data.weight(k, e) > 0.0)) continue;
      const double beside = median_beside(jump, data.weight.col(e), k, 1);
      const bool highest =
          jump.segment(std::max<Eigen::Index>(0, k - 1), std::min<Eigen::Index>(lines - 1, k + 1) -
                                                             std::max<Eigen::Index>(0, k - 1) + 1)
              .maxCoeff() <= jump(k);
      if (highest && jump(k) > Constants::jump * beside) found.push_back({k, e, 0.0, 0.0});
    }
  }
  return found;
}

}  // namespace

Eigen::MatrixXd powers_of(const ModalFit& fit, Eigen::Index m, const FitData& data) {
  ModalFit alone;
  alone.model = fit.model;
  alone.model.rigid_count = m < fit.model.rigid_count ? 1 : 0;
  alone.model.frequency_hz = fit.model.frequency_hz.segment(m, 1);
  alone.model.damping_ratio = fit.model.damping_ratio.segment(m, 1);
  alone.model.output_shapes = fit.model.output_shapes.col(m);
  alone.model.input_shapes = fit.model.input_shapes.row(m);
  alone.model.residual.setZero();
  if (fit.complex) {
    alone.complex.emplace();
    alone.complex->outputs = fit.complex->outputs.col(m);
    alone.complex->inputs = fit.complex->inputs.row(m);
  }
  return responses(alone, data.frequency_hz).cwiseAbs2().cwiseProduct(data.weight.cwiseAbs2());
}

namespace {

// Values in the lines that carry most of one mode: such a mode may exist only because of them.
std::vector<OutlyingValue> sole_supports(const FitData& data, const ModalFit& fit) {
  std::vector<OutlyingValue> found;
  for (auto m = fit.model.rigid_count; m < fit.model.mode_count(); ++m) {
    const auto power = powers_of(fit, m, data);
    const Eigen::VectorXd lines = power.rowwise().sum();
    Eigen::Index k = 0;
    const double most = lines.maxCoeff(&k);
    if (most < Constants::sole_line * lines.sum()) continue;
    for (Eigen::Index e = 0; e < power.cols(); ++e) {
      if (power(k, e) > Constants::sole_response * most) found.push_back({k, e, 0.0, 0.0});
    }
  }
  return found;
}

FitData without(const FitData& data, const std::vector<OutlyingValue>& values) {
  FitData result = data;
  for (const auto& outlier : values) {
    result.value(outlier.line, outlier.response) = 0.0;
    result.weight(outlier.line, outlier.response) = 0.0;
  }
  return result;
}

// All measured values of the candidates' lines, if these lines are few. A fault in one value of a
// line often reaches others of the line; if those stay, they distort the fit again.
std::vector<OutlyingValue> whole_lines(const FitData& data, std::vector<OutlyingValue> candidates) {
  std::set<Eigen::Index> lines;
  for (const auto& candidate : candidates) lines.insert(candidate.line);
  if (static_cast<double>(lines.size()) >
      Constants::most_outlying * static_cast<double>(data.line_count())) {
    return candidates;
  }
  candidates.clear();
  for (const auto line : lines) {
    for (Eigen::Index e = 0; e < data.response_count(); ++e) {
      if (data.weight(line, e) > 0.0) candidates.push_back({line, e, 0.0, 0.0});
    }
  }
  return candidates;
}

// The candidates that the fit without them contradicts.
std::vector<OutlyingValue> confirmed(const FitData& data, const ModalFit& clean,
                                     const std::vector<OutlyingValue>& candidates) {
  const auto outliers = outlying_of(data, clean);
  std::vector<OutlyingValue> kept;
  for (const auto& outlier : outliers) {
    const bool asked = std::any_of(candidates.begin(), candidates.end(), [&](const auto& other) {
      return other.line == outlier.line && other.response == outlier.response;
    });
    if (asked) kept.push_back(outlier);
  }
  return kept;
}

// Distance of a mode of `fit` to the nearest mode of `other`, in joint deviations.
double distance(const ModalFit& fit, Eigen::Index m, const ModalFit& other) {
  double nearest = std::numeric_limits<double>::infinity();
  for (auto i = other.model.rigid_count; i < other.model.mode_count(); ++i) {
    const double frequency = std::abs(fit.model.frequency_hz(m) - other.model.frequency_hz(i)) /
                             std::hypot(fit.frequency_std_hz(m), other.frequency_std_hz(i));
    const double damping = std::abs(fit.model.damping_ratio(m) - other.model.damping_ratio(i)) /
                           std::hypot(fit.damping_std(m), other.damping_std(i));
    nearest = std::min(nearest, std::max(frequency, damping));
  }
  return nearest;
}

// States how the modes differ, as a sentence; empty if they do not.
std::string difference(const ModalFit& found, const ModalFit& clean) {
  TextWriter text;
  if (found.model.mode_count() != clean.model.mode_count()) {
    text << "without them there are " << clean.model.mode_count() << " modes instead of "
         << found.model.mode_count();
    return text.str();
  }
  double most = 0.0;
  Eigen::Index which = 0;
  for (auto m = found.model.rigid_count; m < found.model.mode_count(); ++m) {
    const double here = distance(found, m, clean);
    if (here > most) {
      most = here;
      which = m;
    }
  }
  if (!(most > Constants::no_chance)) return {};
  text << "without them the mode at " << found.model.frequency_hz(which) << " Hz moves by " << most
       << " deviations";
  return text.str();
}

// Whether a mode has a third of its power in the lines of these values.
bool lives_of(const ModalFit& fit, const FitData& data, const std::vector<OutlyingValue>& values) {
  for (const auto& support : sole_supports(data, fit)) {
    for (const auto& outlier : values) {
      if (outlier.line == support.line && outlier.response == support.response) return true;
    }
  }
  return false;
}

}  // namespace

void look_for_outliers(const Identified& found, const FitData& data,
                       const std::optional<IdentificationOptions>& again, Judgement& judgement) {
  auto candidates = outlying_of(data, found.fit);
  if (!again || data.response_count() > Constants::most_refitted) {
    judgement.outlying = std::move(candidates);
    return;
  }
  const auto add = [&](const std::vector<OutlyingValue>& more) {
    candidates.insert(candidates.end(), more.begin(), more.end());
  };
  add(sole_supports(data, found.fit));
  if (judgement.level > Constants::bad_level || judgement.unexplained > Constants::most_unexplained)
    add(jumps_of(data));
  const double values = 0.5 * static_cast<double>(data.measured_count());
  if (candidates.empty() ||
      static_cast<double>(candidates.size()) > Constants::most_outlying * values)
    return;
  candidates = whole_lines(data, std::move(candidates));
  try {
    const auto clean = identified(without(data, candidates), *again);
    judgement.outlying = confirmed(data, clean.fit, candidates);
    if (judgement.outlying.empty()) return;
    // Where no variance is stated, deviations are guesses and weak modes appear and disappear.
    const bool bent = data.noise_stated || judgement.level > Constants::bad_level ||
                      judgement.unexplained > Constants::most_unexplained ||
                      lives_of(found.fit, data, judgement.outlying);
    const auto how = bent ? difference(found.fit, clean.fit) : std::string();
    if (!how.empty()) judgement.reasons.push_back("outlying values decide the result: " + how);
  } catch (const InvalidInput&) {  // no mode is left without them
    judgement.outlying = std::move(candidates);
    judgement.reasons.emplace_back("without the values that jump nothing stands out of the noise");
  }
}

}  // namespace chladni::identification
