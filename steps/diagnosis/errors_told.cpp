#include "steps/diagnosis/errors_told.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "diagnosis/effect.h"
#include "diagnosis/error_band.h"

namespace chladni::steps {
namespace {

using Eigen::Index;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// Σ |G|² and Σ |G − Ĝ|² over the measured responses of line k.
struct LineSums {
  double size = 0.0, error = 0.0;
};

LineSums sums_at(const modal::FrfSet& measured, const std::vector<Eigen::MatrixXcd>& predicted,
                 std::size_t k) {
  LineSums sums;
  const Eigen::MatrixXcd& value = measured.value[k];
  for (Index e = 0; e < value.size(); ++e) {
    if (!std::isfinite(std::abs(value(e)))) continue;
    sums.size += std::norm(value(e));
    if (!predicted.empty()) sums.error += std::norm(value(e) - predicted[k](e));
  }
  return sums;
}

// Relative error of each line; empty: no prediction.
Eigen::VectorXd relative_errors(const modal::FrfSet& measured,
                                const std::vector<Eigen::MatrixXcd>& predicted) {
  if (predicted.empty()) return {};
  Eigen::VectorXd error(measured.line_count());
  for (Index k = 0; k < error.size(); ++k) {
    const auto sums = sums_at(measured, predicted, static_cast<std::size_t>(k));
    error(k) = sums.size > 0.0 ? std::sqrt(sums.error / sums.size) : kUnknown;
  }
  return error;
}

const diagnosis::ModeDifference* partner_of(const diagnosis::ModeComparison& modes,
                                            Index measured) {
  const auto pair = std::ranges::find(modes.pairs, measured, &diagnosis::ModeDifference::measured);
  return pair == modes.pairs.end() ? nullptr : &*pair;
}

// True for a gain, a delay, a low-pass or a quantity: of the record, and not of the structure.
bool is_in_path(const diagnosis::Cause& cause) {
  constexpr std::array<std::string_view, 4> kOfRecords{"gain", "delay", "low_pass", "quantity"};
  return std::ranges::any_of(diagnosis::effect(cause.effect).in_study.keys,
                             [&](const diagnosis::StudyKey& key) {
                               return std::ranges::find(kOfRecords, key.key) != kOfRecords.end();
                             });
}

// A structure has no records. Where a cause is in them, the MACs are those of the reduced model,
// which does.
void take_mac_of_records(const diagnosis::Diagnosis& result,
                         std::vector<diagnosis::ModeTold>& told) {
  if (std::ranges::none_of(result.best.causes, is_in_path)) return;
  for (auto& mode : told) {
    const auto found =
        std::ranges::find(result.modes, mode.measured_hz, &diagnosis::ModeTold::measured_hz);
    if (found == result.modes.end()) continue;
    if (!std::isfinite(found->mac_before) || !std::isfinite(found->mac_after)) continue;
    mode.mac_before = found->mac_before;
    mode.mac_after = found->mac_after;
  }
}

}  // namespace

std::vector<diagnosis::ModeTold> modes_of_responses(const Diagnosed& one,
                                                    const identification::ModalFit& fit,
                                                    const diagnosis::Structure* after) {
  const auto& before = one.comparison.modes;
  diagnosis::ModeComparison extended;
  if (after != nullptr) extended = diagnosis::compared(*after, one.seen, &fit).modes;
  std::vector<diagnosis::ModeTold> told;
  for (const Index column : before.measured_modes) {
    diagnosis::ModeTold mode;
    mode.measured_hz = fit.model.frequency_hz(column);
    mode.measured_std_hz = fit.frequency_std_hz(column);
    const auto* was = partner_of(before, column);
    const auto* is = partner_of(extended, column);
    mode.before_hz = was != nullptr ? was->simulated_hz : kUnknown;
    mode.mac_before = was != nullptr ? was->mac : kUnknown;
    mode.after_hz = is != nullptr ? is->simulated_hz : kUnknown;
    mode.mac_after = is != nullptr ? is->mac : kUnknown;
    told.push_back(mode);
  }
  if (after != nullptr) take_mac_of_records(one.result, told);
  std::ranges::stable_sort(told, {}, &diagnosis::ModeTold::measured_hz);
  return told;
}

ErrorsOverFrequency errors_over_frequency(const Diagnosed& one,
                                          const diagnosis::Tolerances& tolerances) {
  const auto& set = one.measured.all;
  const auto& after =
      one.predictions.fitted.empty() ? one.predictions.extended : one.predictions.fitted;
  ErrorsOverFrequency errors{set.frequency_hz, relative_errors(set, one.predictions.before),
                             relative_errors(set, after),
                             Eigen::VectorXd::Constant(set.line_count(), kUnknown),
                             Eigen::VectorXd::Constant(set.line_count(), kUnknown)};
  const auto levels = diagnosis::with_levels(tolerances, one.result.levels_after);
  const auto band = diagnosis::error_band(one.structure, set, levels);
  Index line = 0;
  for (Index k = 0; k < band.frequency_hz.size(); ++k) {
    while (line < set.line_count() && set.frequency_hz(line) < 0.999999 * band.frequency_hz(k)) {
      ++line;
    }
    if (line == set.line_count()) break;
    const double size = sums_at(set, {}, static_cast<std::size_t>(line)).size;
    if (!(size > 0.0)) continue;
    errors.noise(line) = std::sqrt(band.noise(k) / size);
    errors.expected(line) = std::sqrt((band.noise(k) + band.model(k)) / size);
  }
  return errors;
}

}  // namespace chladni::steps
