// Modes measured before something changed: the structure is corrected to them, and only what the
// later modes need beyond it is a cause.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/measured_modes.h"
#include "diagnosis/modes/errors/levels.h"
#include "diagnosis/structure.h"
#include "diagnosis/tolerances.h"

namespace chladni::diagnosis {

/// Channels that have a value in mode i of one measurement and in mode j of the other.
[[nodiscard]] std::vector<Eigen::Index> rows_of_both(const Eigen::MatrixXcd& a, Eigen::Index i,
                                                     const Eigen::MatrixXcd& b, Eigen::Index j);

/// For each later mode the mode of the reference that it was; −1: none. At least total cost
/// (modal::assigned): 1 − MAC plus the square of ln(frequency ratio) over Constants::apart. The
/// channels of both are the same ones.
[[nodiscard]] std::vector<Eigen::Index> earlier_modes(const MeasuredModes& later,
                                                      const MeasuredModes& reference);

/// Both measurements with the channels that both have. A measurement without shapes leaves
/// frequencies and damping alone to compare.
struct Common {
  MeasuredModes later, reference;
  std::vector<std::string> notes;  ///< of the channels that were left out
};
/// @throws InvalidInput  no mode in one of them; both have sensors, and none in common; no mode in
///                       common. Cost: of matching the modes
[[nodiscard]] Common common(const MeasuredModes& later, const MeasuredModes& reference);

/// A structure whose modes are those of the reference, and the later modes in its scale.
struct Referred {
  Structure structure;
  MeasuredModes measured;
  Eigen::VectorXd reference_hz;  ///< of each mode of `measured`; NaN: the reference has none
  std::vector<std::string> notes;
};
/// The reference's modes are paired with those of the structure under a model-form error of learned
/// level. Then the stiffness is corrected, K = V Λ Vᵀ + (1 − V Vᵀ) s² K₀ (1 − V Vᵀ): Λ has the
/// measured frequencies, V the modes of the structure, turned among neighbours as the measured
/// shapes say, and s is the median ratio of the frequencies. Damping ratios and the shapes at the
/// channels are those of the reference, too. So the errors that the model has both before and after
/// cancel. The deviations of both measurements add, and those of a change have a part in proportion
/// to it (Constants::change_error).
///
/// A later mode that the reference lacks has the deviations of the model besides. A mode that both
/// measurements have and the structure lacks is left out.
/// Source: Baruch and Bar Itzhack, AIAA Journal 16 (1978) 346, for stiffness corrected to reference
/// modes.
/// Cost: one fit of levels, 10 to 50 ms.
/// @param later, reference  with the same channels as the structure, in its order
/// @throws InvalidInput  no mode of the structure is among those of the reference
[[nodiscard]] Referred referred(const Structure& structure, const MeasuredModes& later,
                                const MeasuredModes& reference, const Tolerances& tolerances);

/// Tolerances of the body between two measurements: one temperature is all that it has.
[[nodiscard]] Tolerances repeatable(const Tolerances& tolerances);
/// Levels by which two measurements of an unchanged structure differ, instead of those of a model.
[[nodiscard]] LevelPrior repeatability(const Tolerances& tolerances, bool learned);

}  // namespace chladni::diagnosis
