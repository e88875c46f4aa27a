// Errors that a sound structure has: of its body as a whole, and of its shapes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/structure.h"
#include "diagnosis/tolerances.h"

namespace chladni::diagnosis {

/// Factor L of the correlation LLᵀ of a smooth shape error between all channels, sensors first:
/// Matérn's with exponent 3/2, over a fifth of the body, of each component of a displacement
/// alike: a channel against another one has the opposite error, one across it an independent one.
/// (p + q)².
[[nodiscard]] Eigen::MatrixXd smooth_factor(const Structure& structure);

/// A change of stiffness and mass of the body, r×r or empty where there is none, for an error of 1
/// (of a class), or for one standard deviation (−1).
struct BodyError {
  int of = -1;
  Eigen::MatrixXd stiffness, mass;
};
/// The tolerances of the body in that form.
/// @param uniform_thickness  false: the tolerance of the thickness is that of its waves alone
[[nodiscard]] std::vector<BodyError> body_errors(const Structure& structure,
                                                 const Tolerances& tolerances,
                                                 bool uniform_thickness = true);

}  // namespace chladni::diagnosis
