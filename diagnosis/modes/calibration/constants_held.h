// Constants of a study as coordinates that every hypothesis about modes has.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/calibrated.h"
#include "diagnosis/effect.h"
#include "diagnosis/tolerances.h"

namespace chladni::diagnosis {

/// A constant: its effect has one coordinate, the logarithm of the constant over the study's.
struct HeldConstant {
  CalibratedConstant stated;
  const Effect* effect = nullptr;
  double width = 0.0;  ///< of the prior of its coordinate
};

/// The effect of a constant, whose one coordinate is the logarithm of the constant over the
/// study's. An effect of the catalogue that has the same name leaves the losses instead of the
/// damping ratios.
/// @throws InvalidInput  no such effect; the message names the constant
[[nodiscard]] const Effect& held_effect(const std::string& constant, std::string_view name);

/// Those that the structure can show, directions of the stiffness first, with their widths: what
/// was stated, but for `known` not less than the tolerance. A note for each of the others.
/// @throws InvalidInput  no such effect; two constants of one effect; a deviation that is not above
/// 0
[[nodiscard]] std::vector<HeldConstant> held_constants(
    const Structure& structure, const std::vector<CalibratedConstant>& constants,
    const Tolerances& tolerances, std::vector<std::string>& notes);

/// The effects that are sought beside these constants: not those that a constant does as widely.
/// A constant that was measured may also be a blunder, so its effect stays.
[[nodiscard]] std::vector<const Effect*> sought_beside(const std::vector<HeldConstant>& constants,
                                                       std::vector<const Effect*> catalogue,
                                                       const Structure& structure);

/// The tolerances without those that a constant takes over. `uniform_thickness`: whether the
/// tolerance of the thickness still means the whole body, and not only its waves.
struct LeftTolerances {
  Tolerances tolerances;
  bool uniform_thickness = true;
};
[[nodiscard]] LeftTolerances tolerances_left(const std::vector<HeldConstant>& constants,
                                             const Tolerances& tolerances);

/// ln of the prior density of the coordinates; −∞ beyond kPlausible widths.
[[nodiscard]] double log_prior(const std::vector<HeldConstant>& constants,
                               const Eigen::VectorXd& x);

}  // namespace chladni::diagnosis
