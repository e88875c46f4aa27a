// Scores a diagnosis against the hidden effects.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/diagnosed.h"
#include "simulators/hidden/hidden_effect.h"

namespace chladni::simulators {

/// A size, as hidden and as diagnosed.
struct SizeScore {
  std::string name;
  double truth = 0.0, value = 0.0, std = 0.0;

  [[nodiscard]] double z() const { return (value - truth) / std; }
  [[nodiscard]] double relative_error() const { return (value - truth) / truth; }
};

/// One effect of the truth, in the best explanation.
struct EffectScore {
  std::string kind;
  bool named = false;            ///< the diagnosis has its name, on its channels
  std::vector<SizeScore> sizes;  ///< where named; places as "u" and "v"
  double place_error = 0.0;      ///< [m]
  bool placed = false;
};

enum class Outcome {
  right,    ///< every cause and no other, named; "nothing" where there is nothing
  twin,     ///< named or ambiguous as something indistinguishable from it (evidence_apart < 5)
  open,     ///< every cause and no other, but partial: something remains
  phantom,  ///< every cause and one more that does not exist
  among,    ///< ambiguous, and the truth is among the rivals or first
  half,     ///< of several, some
  wrong,    ///< another name
  missed,   ///< nothing was seen
  unexplained,
};
[[nodiscard]] std::string_view name(Outcome outcome);

struct CaseScore {
  Outcome outcome = Outcome::missed;
  std::vector<EffectScore> effects;
  std::string told;      ///< "named: point_mass 0.99", for a table
  std::string phantoms;  ///< causes not in the truth, with numbers: "point_mass mass=0.0012"
  /// The highest probability of a cause that is not in the truth, for any verdict; 0: none. A cause
  /// that cannot be distinguished from the truth counts as truth.
  double surest_phantom = 0.0;

  [[nodiscard]] bool confidently_wrong() const { return surest_phantom > 0.9; }
};

[[nodiscard]] CaseScore scored(const HiddenCase& hidden, const diagnosis::Diagnosis& told);

/// The effect of the catalogue for this kind; empty for kinds outside the catalogue.
[[nodiscard]] std::string effect_of_kind(const std::string& kind);

}  // namespace chladni::simulators
