// Gain of naming a cause: errors of the predicted responses before and after, on fitted data and on
// held-out data.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/cross_validation.h"
#include "diagnosis/mode_told.h"
#include "steps/identification.h"
#include "study/diagnosis_plan.h"

namespace chladni::steps {

/// Origin of the responses after the diagnosis.
enum class GainFrom {
  nothing,         ///< no cause was named
  extended_study,  ///< extended.toml, its finite elements solved
  fitted_model     ///< the reduced model with all causes, if a study cannot express one
};
[[nodiscard]] std::string_view name(GainFrom from);

/// Channels and lines of one kind: fitted, or held out.
struct MeasuredPart {
  std::vector<std::string> sensors, actuators;
  std::vector<std::pair<double, double>> bands_hz;  ///< from first to last line, ascending
  Eigen::Index lines = 0;
};

/// Relative errors |G − Ĝ| over |G|, over all responses and lines of a set; NaN: nothing to
/// compare.
struct Gain {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  double fit_before = kNone, fit_after = kNone;            ///< on the data of the fit
  double held_out_before = kNone, held_out_after = kNone;  ///< on held-out channels and lines
  double noise_floor = kNone, held_out_noise = kNone;
  GainFrom from = GainFrom::nothing;  ///< origin of the values after
  /// Errors of extended.toml, if it was solved but lacks a cause; the values after are then those
  /// of the fitted model.
  double fit_extended = kNone, held_out_extended = kNone;
  /// Root mean squares of the relative differences of the modes' frequencies, measured and
  /// simulated. Where the model's errors put resonances beside each other, a response tells how
  /// these miss each other and not what is right: then a cause also pays where frequencies are
  /// nearer.
  double frequencies_before = kNone, frequencies_after = kNone;
  /// Likewise the sines between the shapes, where no frequency changes: that of a channel.
  double shapes_before = kNone, shapes_after = kNone;
  MeasuredPart fitted;
  std::vector<std::string> held_out;                        ///< in words: channels, bands
  std::vector<std::pair<double, double>> held_out_band_hz;  ///< one or none
  /// True where the study states no hold-out: the values held out are those of sensors and blocks
  /// of lines that were held out in turn, with the reduced model in `after`.
  bool in_turn = false;
  /// True if the extended study is nearer to the measurement, on held-out data and (if known) on
  /// fitted data; none if no extended study was solved. In turn, the gain of the cross-validation
  /// stands for the held-out data.
  std::optional<bool> pays;
  /// Likewise of the fitted model with all causes, where `after` is of it; else none. It is all
  /// that is known of causes that no study can express.
  std::optional<bool> fitted_pays;
};

/// Relative errors |G − Ĝ| over |G| of each line, over all its responses; k each. NaN: not known.
struct ErrorsOverFrequency {
  Eigen::VectorXd frequency_hz;
  Eigen::VectorXd before, after;  ///< `after` is empty where nothing was predicted anew
  Eigen::VectorXd noise;          ///< by the stated deviations
  Eigen::VectorXd expected;       ///< by noise and errors of a sound model (tolerances, or levels)
};

/// Responses [k], each p×q as MeasuredFrfs::all; empty: not known.
struct Predictions {
  std::vector<Eigen::MatrixXcd> before, extended, fitted;
};

/// @param predictions  `before` for every measured line
/// @param tested       used where no channel and no band is held out; or null
[[nodiscard]] Gain gain_of(const MeasuredFrfs& measured, const study::DiagnosisPlan& plan,
                           const std::vector<std::string>& held_out_channels,
                           const Predictions& predictions,
                           const diagnosis::CrossValidation* tested = nullptr);

/// Lets the frequencies of the modes decide, where the extended study changes them, or else their
/// shapes (the sine is that of vectors over the channels, √(1 − MAC)).
void judge_by_modes(const std::vector<diagnosis::ModeTold>& modes, Gain& gain);

/// The reason not to use the named causes, or empty: "The extended study predicts what was held out
/// worse than the study does (38 % off, 24 % before): it is not recommended."
[[nodiscard]] std::string advice_against(const Gain& gain);

/// "s1, s3" for a part of sensors; "20 to 97.4 Hz" for one of lines.
[[nodiscard]] std::string words(const diagnosis::HeldOutPart& part);

/// "s1, s2 by a1, a2; 300 lines, 20 to 900 Hz"
[[nodiscard]] std::string words(const MeasuredPart& part);

/// True if the line is held out of every fit.
[[nodiscard]] bool line_held_out(const study::DiagnosisPlan& plan, double frequency_hz);

}  // namespace chladni::steps
