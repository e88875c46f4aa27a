// How near a diagnosis came to what was hidden.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/diagnosed.h"
#include "simulators/hidden_effect.h"

namespace chladni::simulators {

/// A size, as hidden and as told.
struct SizeScore {
  std::string name;
  double truth = 0.0, value = 0.0, std = 0.0;

  [[nodiscard]] double z() const { return (value - truth) / std; }
  [[nodiscard]] double relative_error() const { return (value - truth) / truth; }
};

/// One effect of the truth, in the best explanation.
struct EffectScore {
  std::string kind;
  bool named = false;            ///< its name is there, on its channels
  std::vector<SizeScore> sizes;  ///< where named; places as "u" and "v"
  double place_error = 0.0;      ///< [m]
  bool placed = false;
};

enum class Outcome {
  right,   ///< every cause and no other; "nothing" where there is nothing
  among,   ///< ambiguous, partial or with more causes, and the truth is among them
  half,    ///< of several, some
  wrong,   ///< another name
  missed,  ///< nothing was seen
  unexplained,
};
[[nodiscard]] std::string_view name(Outcome outcome);

struct CaseScore {
  Outcome outcome = Outcome::missed;
  std::vector<EffectScore> effects;
  std::string told;  ///< "named: point_mass", for a table
  /// Called named, with a cause of probability above 0.9 that is not of the truth.
  bool confidently_wrong = false;
};

[[nodiscard]] CaseScore scored(const HiddenCase& hidden, const diagnosis::Diagnosis& told);

/// The effect of the catalogue that is this kind; empty for kinds outside of it.
[[nodiscard]] std::string effect_of_kind(const std::string& kind);

}  // namespace chladni::simulators
