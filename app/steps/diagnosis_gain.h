// What naming a cause gains: errors of the predicted responses before and after, on what a fit saw
// and on what it did not.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/steps/identification.h"
#include "app/study/diagnosis_plan.h"

namespace chladni::app {

/// Where the responses after come from.
enum class GainFrom {
  nothing,         ///< no cause was named
  extended_study,  ///< extended.toml, its finite elements solved
  fitted_model     ///< the reduced model of the fit with all causes: of some no study has a key
};
[[nodiscard]] std::string_view name(GainFrom from);

/// Channels and lines of one kind: fitted, or held out.
struct MeasuredPart {
  std::vector<std::string> sensors, actuators;
  std::vector<std::pair<double, double>> bands_hz;  ///< from first to last line, ascending
  Eigen::Index lines = 0;
};

/// Relative errors |G − Ĝ| over |G|, over all responses and lines of a set; NaN where there is
/// nothing to compare.
struct Gain {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  double fit_before = kNone, fit_after = kNone;            ///< on what the diagnosis saw
  double held_out_before = kNone, held_out_after = kNone;  ///< on channels and lines it did not
  double noise_floor = kNone, held_out_noise = kNone;
  GainFrom from = GainFrom::nothing;  ///< of what is after
  /// Of extended.toml where it was solved and lacks a cause: what is after is of the fitted model.
  double fit_extended = kNone, held_out_extended = kNone;
  MeasuredPart fitted;
  std::vector<std::string> held_out;                        ///< in words: channels, bands
  std::vector<std::pair<double, double>> held_out_band_hz;  ///< one or none
  /// Whether the extended study is nearer to what was measured, held out and (where that is
  /// known) seen; none where no extended study was solved.
  std::optional<bool> pays;
};

/// Responses [k], each p×q as MeasuredFrfs::all; empty: not known.
struct Predictions {
  std::vector<Eigen::MatrixXcd> before, extended, fitted;
};

/// @param predictions  `before` as long as the measured lines
[[nodiscard]] Gain gain_of(const MeasuredFrfs& measured, const DiagnosisPlan& plan,
                           const std::vector<std::string>& held_out_channels,
                           const Predictions& predictions);

/// Why nobody should act on what was named, or empty: "The extended study predicts what was held
/// out worse than the study does (38 % off, 24 % before): it is not recommended."
[[nodiscard]] std::string advice_against(const Gain& gain);

/// "s1, s2 by a1, a2; 300 lines, 20 to 900 Hz"
[[nodiscard]] std::string words(const MeasuredPart& part);

/// Whether no fit may see a line.
[[nodiscard]] bool line_held_out(const DiagnosisPlan& plan, double frequency_hz);

}  // namespace chladni::app
