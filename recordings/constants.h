// What decides in this room: which responses are believed, and what a transient is.
// docs/reference/constants_identification.md has the same list, with what was seen when one was
// halved and doubled; a test compares both.
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace chladni::recordings {

/// Each comment says what the constant decides [unit] (source).
struct Constants {
  /// Lines over which the power of a decay is averaged [lines] (chosen, 4e93688).
  static constexpr Eigen::Index decay_group = 16;
  /// Number of such groups that decide on the decays, the clearest ones [groups] (chosen, 4e93688).
  static constexpr std::size_t decay_groups = 64;
  /// Shift of the mean by a decay above which a further period is dropped [deviations] (chosen,
  /// 4e93688).
  static constexpr double decay_tolerated = 0.1;
  /// Evidence of a decay above which it is believed [deviations] (chosen, 4e93688).
  static constexpr double decay_significant = 6.0;
  /// Least power of the noise of an output over the power of the output [1] (chosen, 4e93688).
  static constexpr double least_noise_power = 1e-8;
  /// Condition of a sensitivity above which a line is noted [1] (chosen, f38379f).
  static constexpr double hard_to_invert = 1e3;
  /// Least singular value of a sensitivity below which a line is noted [deviations] (chosen,
  /// f38379f).
  static constexpr double clear_sensitivity = 3.0;
  /// Freedom of a variance that the average over lines aims at [degrees of freedom] (chosen,
  /// 4e93688).
  static constexpr double enough_freedom = 14.0;
  /// Most lines on each side over which variances are averaged [lines] (chosen, 4e93688).
  static constexpr Eigen::Index most_smoothing = 5;
  /// Probability, before the lines say anything, that noise grows with the response [1] (chosen).
  static constexpr double growth_chance = 0.05;
  /// Frequency above which folding is noted [sampling frequencies] (chosen, 4e93688).
  static constexpr double folds_from = 0.4;
  /// Force outside the window over its peak above which a second hit is noted [1] (chosen,
  /// f38379f).
  static constexpr double double_hit = 0.05;
  /// Response in the last twentieth of a record over its largest value above which a note asks for
  /// a longer record [1] (chosen, f38379f).
  static constexpr double at_rest = 0.02;
};

}  // namespace chladni::recordings
