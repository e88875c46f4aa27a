// Cross-validation: how well causes predict data that their sizes were fitted without.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace chladni::diagnosis {

/// Sums over the responses and lines of a part of the data [m²/N²].
struct PredictionErrors {
  double before = 0.0;  ///< Σ |G − Ĝ|² of the simulation as it is
  double after = 0.0;   ///< with the causes; all tolerances at 0 in both
  double size = 0.0;    ///< Σ |G|²
  double noise = 0.0;   ///< Σ σ²

  PredictionErrors& operator+=(const PredictionErrors& more);
  /// Root of a sum over that of the size; NaN: nothing was measured.
  [[nodiscard]] double relative(double sum) const {
    return size > 0.0 ? std::sqrt(sum / size) : std::numeric_limits<double>::quiet_NaN();
  }
};

/// A part of the data: every line of some sensors, or every response of a band.
struct HeldOutPart {
  enum class Kind {
    sensors,    ///< one sensor in turn; of many sensors a few at a time
    lines,      ///< a block of lines with whole resonances
    upper_band  ///< the upper part of the band
  };
  Kind kind = Kind::sensors;
  std::vector<std::string> sensors;    ///< those of the part, or all
  double low_hz = 0.0, high_hz = 0.0;  ///< first and last line
  PredictionErrors errors;
  /// [ln] Fall of ½(χ² + ηᵀη) by the causes, with the tolerances that suit the part best.
  double gain = 0.0;
  /// [ln], by each cause beside the others; 0 where it was left out. Others that were left out are
  /// as all data have them.
  std::vector<double> gain_of_cause;
};

/// Each part was predicted with causes whose numbers were fitted to all other data. A cause for
/// which these alone are no evidence was left out.
struct CrossValidation {
  std::vector<HeldOutPart> parts;

  /// [ln] The gain over the parts of a kind: by all causes, or by cause `which` beside the others.
  [[nodiscard]] double gain(HeldOutPart::Kind kind, std::optional<std::size_t> which = {}) const;
  /// True if sensors and blocks of lines gain together, and neither loses more than
  /// Constants::held_out_loss of what the other gains. A cause that only a few lines ask for makes
  /// other lines worse. The upper band does not count: far away a good cause may err, too.
  [[nodiscard]] bool pays(std::optional<std::size_t> which = {}) const;
  /// Sums over the parts of a kind.
  [[nodiscard]] PredictionErrors errors(HeldOutPart::Kind kind) const;
  /// Sums over sensors and blocks of lines: every number that was measured, at most twice.
  [[nodiscard]] PredictionErrors errors() const;
};

}  // namespace chladni::diagnosis
