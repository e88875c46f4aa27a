#include "diagnosis/verdict/stability.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "diagnosis/constants.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

constexpr std::size_t kNearTold = 3;  // explanations that a note names

// Measured numbers that the deviations use up: n − tr H⁻¹, with their prior precision of 1.
double taken_by_deviations(const Fit& fit) {
  const Index n = fit.eta.size();
  if (fit.covariance.rows() < n) return 0.0;
  return static_cast<double>(n) - fit.covariance.diagonal().tail(n).sum();
}

// "sensor_gain of y1 and density"
std::string effects_of(const Explanation& explanation) {
  std::string text;
  for (const auto& cause : explanation.causes) {
    text += (text.empty() ? "" : " and ") + cause.effect;
    if (!cause.channels.empty()) text += fmt::format(" of {}", fmt::join(cause.channels, ", "));
  }
  return text;
}

}  // namespace

Structure nudged(Structure structure) {
  const auto sign = [](Index i) {
    return i % 2 == 0 ? kConstants.last_bits : -kConstants.last_bits;
  };
  for (Index k = 0; k < structure.mode_count(); ++k) {
    structure.frequency_hz(k) *= 1.0 + sign(k / 2);
    for (auto* side : {&structure.outputs, &structure.inputs}) {
      for (Index i = 0; i < side->count(); ++i) side->shapes(i, k) *= 1.0 + sign(i + k);
    }
  }
  return structure;
}

std::vector<std::size_t> not_repeated(const Structure& structure, const Fit& named,
                                      const Fit& again) {
  std::vector<std::size_t> lost;
  for (std::size_t c = 0; c < named.causes.size(); ++c) {
    Fit single;
    single.causes = {named.causes[c]};
    const bool repeated = std::ranges::any_of(again.causes, [&](const Supposed& cause) {
      Fit other;
      other.causes = {cause};
      return alike(structure, single, other);
    });
    if (!repeated) lost.push_back(c);
  }
  return lost;
}

bool is_doubtful(const Diagnosis& diagnosis, const Fit& best) {
  const auto& causes = diagnosis.best.causes;
  if (diagnosis.verdict == Verdict::partial) {
    return std::ranges::any_of(causes,
                               [](const Cause& c) { return c.probability > kConstants.believed; });
  }
  return !causes.empty() && diagnosis.verdict != Verdict::unexplained && !best.converged;
}

std::string doubt(const Structure& structure, const Fit& best, const Found& second,
                  Diagnosis& diagnosis) {
  const Fit& again = second.fits.front();
  Fit any;
  for (const auto& fit : second.fits) {
    if (fit.log_evidence < again.log_evidence - kConstants.occam_margin) continue;
    any.causes.insert(any.causes.end(), fit.causes.begin(), fit.causes.end());
  }
  const auto lost = not_repeated(structure, best, any);
  if (lost.empty()) return "";
  std::string names;
  for (const auto which : lost) {
    auto& cause = diagnosis.best.causes[which];
    cause.probability = std::min(cause.probability, kConstants.believed);
    names += (names.empty() ? "" : ", ") + cause.effect;
  }
  if (diagnosis.verdict == Verdict::named) diagnosis.verdict = Verdict::partial;
  std::string instead;
  for (const auto which : not_repeated(structure, again, best)) {
    instead += (instead.empty() ? "" : ", ") + std::string(again.causes[which].effect->name);
  }
  return fmt::format(
      "not stable: a search from modes that differ by 1e{:.0f} does not name {} again{}",
      std::log10(kConstants.last_bits), names, instead.empty() ? "" : " but " + instead);
}

std::string note_on_order(const Diagnosis& diagnosis, double within, double power) {
  const auto& best = diagnosis.best;
  if (best.causes.empty() || diagnosis.verdict == Verdict::named) return "";
  std::vector<std::string> near;
  for (const auto& rival : diagnosis.rivals) {
    if (rival.causes.empty() || !(rival.probability > 0.0)) continue;
    const double apart = std::log(best.probability / rival.probability) / power;
    if (apart < within) near.push_back(effects_of(rival));
  }
  if (near.empty()) return "";
  if (near.size() > kNearTold) {
    const auto more = near.size() - kNearTold;
    near.resize(kNearTold);
    near.push_back(fmt::format("{} more", more));
  }
  return fmt::format(
      "the order of the causes is not certain: within {:.3g} in ln evidence of what is told first "
      "({}) there is {}; rounding errors, of another processor or number of threads, may put "
      "another one first",
      within, effects_of(best), fmt::join(near, "; "));
}

std::string note_on_convergence(const Fit& best, const Fit& nothing) {
  const auto promised = [](const Fit& fit) {
    return std::isfinite(fit.promise)
               ? fmt::format("one more step promises {:.2g} in ln likelihood", fit.promise)
               : std::string("no step leads on");
  };
  if (!best.causes.empty() && !best.converged) {
    return fmt::format(
        "the fit of the causes has not converged ({}): their sizes and "
        "probabilities are not final",
        promised(best));
  }
  if (nothing.converged) return "";
  return fmt::format(
      "the fit of the tolerances alone has not converged ({}): what the causes bring "
      "may be less than is told",
      promised(nothing));
}

std::string note_on_noise(const Fit& best, double numbers) {
  const double used =
      best.chi_square + taken_by_deviations(best) + static_cast<double>(best.coordinate_count());
  const double z = (used - numbers) / std::sqrt(2.0 * numbers);
  if (!(z < kConstants.too_little)) return "";
  return fmt::format(
      "less is left than noise of the stated variances would leave (z = {:.1f}): they "
      "are too large, by about {:.0f} %, or lines share their noise; deviations and "
      "probabilities rest on them",
      z, 100.0 * (numbers / std::max(used, 1.0) - 1.0));
}

}  // namespace chladni::diagnosis
