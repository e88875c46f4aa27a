// Scores a diagnosis of a real rig against what was hidden in it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/diagnosed.h"
#include "simulators/hidden/hidden_score.h"
#include "simulators/rigs/real_rig.h"

namespace chladni::simulators {

/// A cause is sure above this probability.
inline constexpr double kSure = 0.9;
/// A cause is found above this one.
inline constexpr double kFound = 0.5;
/// An effect is clear above this log10 of the judge's ln evidence (RealRigCase::clear). The
/// evidence goes with the square of the size, and a cause needs 8 (Constants::least_evidence): this
/// is three times the size that can be detected, 9 x 8 = 72.
inline constexpr double kClear = 1.857;
/// Scales of the body are told as a class where their probabilities sum to this, and the true one
/// has that part.
inline constexpr double kClass = 0.8, kOfClass = 0.05;

enum class RigVerdict {
  right,       ///< every effect was found, near its place and with its sign, and no sure cause is
               ///< false; nothing sure where nothing is
  as_class,    ///< one scale of the body was hidden, and it is told as one of several scales
  half,        ///< of several effects some were found, and no sure cause is false
  phantom,     ///< an effect was found, and a false cause beside it is sure
  wrong_sure,  ///< no effect was found, and a false cause is sure
  missed,      ///< no effect was found, and no false cause is sure
};
[[nodiscard]] std::string_view name(RigVerdict verdict);

/// A cause with its probability, and whether it is true.
struct Statement {
  std::string cause;  ///< "sensor_sign,s3"
  double probability = 0.0;
  bool is_true = false;
};

/// Numbers with a stated deviation, and how many are within two of them.
struct Coverage {
  int count = 0, good = 0;
};

struct RigScore {
  RigVerdict verdict = RigVerdict::missed;
  std::vector<EffectScore> effects;   ///< of the truth
  std::vector<Statement> statements;  ///< causes of the best explanation
  std::string told;                   ///< the diagnosis's own verdict

  [[nodiscard]] bool has_false_sure() const {
    return verdict == RigVerdict::phantom || verdict == RigVerdict::wrong_sure;
  }
  /// The greatest error over the stated deviation of all sizes and places found; NaN: none. 2 or
  /// less is good.
  [[nodiscard]] double worst_z() const;
  /// [m], the greatest of all places found; NaN: none.
  [[nodiscard]] double place_error() const;
  /// Coverage of all sizes found, and of the coordinates of all places found ("place_u",
  /// "place_v").
  [[nodiscard]] Coverage sizes() const;
  [[nodiscard]] Coverage places() const;
};

/// A cause is true if it has the effect and the channels of one that was hidden. A point mass may
/// be told with inertia, a spring as a small pad and the reverse, within a fifth of the body. Of
/// modes without scale, modulus, density, thickness and size are one cause. A
/// resonator within 5 % of the frequency of a string (RealRigCase::present) is true.
[[nodiscard]] RigScore scored(const RealRigCase& rig, const diagnosis::Diagnosis& told);

}  // namespace chladni::simulators
