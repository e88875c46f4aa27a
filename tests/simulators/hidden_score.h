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
  right,    ///< every cause and no other, named; "nothing" where there is nothing
  twin,     ///< named or ambiguous as what nobody could tell from the truth (evidence_apart < 5)
  open,     ///< every cause and no other, but partial: something is left
  phantom,  ///< every cause and one more that is not there
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
  std::string phantoms;  ///< what is not of the truth, with its numbers: "point_mass mass=0.0012"
  /// The highest probability of a cause that is not of the truth, whatever the verdict; 0: none.
  /// What nobody could tell from the truth counts as of it.
  double surest_phantom = 0.0;

  [[nodiscard]] bool confidently_wrong() const { return surest_phantom > 0.9; }
};

[[nodiscard]] CaseScore scored(const HiddenCase& hidden, const diagnosis::Diagnosis& told);

/// The effect of the catalogue that is this kind; empty for kinds outside of it.
[[nodiscard]] std::string effect_of_kind(const std::string& kind);

}  // namespace chladni::simulators
