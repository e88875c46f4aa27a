// Measured modes beside the modes of a hypothesis: which belong together, and by what they differ.
#pragma once

#include <vector>

#include "diagnosis/fit/deviations.h"
#include "diagnosis/measured_modes.h"
#include "diagnosis/modes/levels.h"
#include "diagnosis/modes/partner.h"
#include "diagnosis/modes/recorded_modes.h"

namespace chladni::diagnosis {

/// Factor L of the correlation LLᵀ of a smooth shape error between all channels, sensors first:
/// Matérn's with exponent 3/2, over a fifth of the body. (p + q)².
[[nodiscard]] Eigen::MatrixXd smooth_factor(const Structure& structure);

/// What tells measured modes apart.
enum class PairBy { shape, frequency };

/// For each measured mode its mode of the hypothesis; −1: it has none.
struct Matching {
  std::vector<Eigen::Index> model;
  std::vector<std::vector<Eigen::Index>> span;  ///< span_of each of these; empty: none
};
/// At least total cost (modal::assigned): 1 − MAC plus the square of ln(frequency ratio) over
/// Constants::apart. Without shapes the frequency alone decides.
[[nodiscard]] Matching matched(const MeasuredModes& measured, const RecordedModes& model,
                               const ShapeUnits& units, PairBy by = PairBy::shape);

/// A change of stiffness and mass of the body, r×r, for an error of 1 (of a class), or for one
/// standard deviation (−1).
struct BodyError {
  int of = -1;
  Eigen::MatrixXd stiffness, mass;
};
/// The tolerances of the body in that form.
[[nodiscard]] std::vector<BodyError> body_errors(const Structure& structure,
                                                 const Tolerances& tolerances);

/// Numbers that are not believed: those of a mode or of a channel.
struct Disturbed {
  enum class What { nothing, mode, sensor, actuator };
  What what = What::nothing;
  Eigen::Index index = 0;
};

/// Measured less model, number by number, in blocks of one measured mode: ln f; ln ζ; the real and
/// imaginary parts of the shape at sensors, then at actuators, each shape of root mean square 1 and
/// turned to the model's phase; ln of the residue, real and imaginary part, where it is known. A
/// mode that is alone, or is not believed, has errors of 1.
/// @param with_shared  false: without the errors that blocks share
[[nodiscard]] ModeErrors mode_errors(const Structure& structure, const MeasuredModes& measured,
                                     const RecordedModes& model, const ShapeUnits& units,
                                     const Matching& matching, const std::vector<BodyError>& body,
                                     const Eigen::MatrixXd& smooth, const Disturbed& disturbed = {},
                                     bool with_shared = true);

}  // namespace chladni::diagnosis
