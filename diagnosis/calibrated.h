// Constants of a study that are not known exactly: what is stated of them, and what is found.
#pragma once

#include <string>

namespace chladni::diagnosis {

/// A constant of the study that every hypothesis may change, also that nothing is wrong.
struct CalibratedConstant {
  enum class Kind {
    known,     ///< to its deviation
    measured,  ///< to its small deviation, or it is a blunder: then its effect is named as a cause
    unknown,   ///< a wide prior in its logarithm
  };
  std::string name;    ///< for people: "material.youngs_modulus"
  std::string unit;    ///< of `value`, SI
  double value = 0.0;  ///< of the study, above 0
  /// What it changes: "youngs_modulus", "density", "thickness", "modal_damping", or the stiffness
  /// of one direction of the chart: "stiffness_along_u", "stiffness_along_v", "shear_stiffness".
  std::string effect;
  double deviation = 0.0;  ///< standard deviation of its logarithm; not for `unknown`
  Kind kind = Kind::known;
};

/// A constant as the data have it, under the best explanation.
struct CalibratedNumber {
  std::string name, unit;         ///< as stated
  std::string effect;             ///< likewise
  double of_study = 0.0;          ///< in `unit`
  double value = 0.0, std = 0.0;  ///< in `unit`
  double prior = 0.0;             ///< relative deviation before the data are seen
  /// False: these data tell nothing of it, and it keeps the value of the study.
  bool determined = true;

  /// Relative change from the study.
  [[nodiscard]] double change() const { return value / of_study - 1.0; }
};

/// Two constants whose deviations go together: only a combination of them is determined.
struct CalibratedPair {
  std::string one, other;    ///< their names
  double correlation = 0.0;  ///< −1 to 1
};

}  // namespace chladni::diagnosis
