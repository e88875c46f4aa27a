// Imaginary parts of complex shapes at places where nothing measures them.
#pragma once

#include <Eigen/Core>

#include "identification/gain_match.h"

namespace chladni::identification {

/// r modes of a simulation with modal damping: its shapes at the n rows of a match and at k places.
struct CouplingBasis {
  Eigen::VectorXd frequency_hz;        ///< r; 0 of rigid-body modes
  Eigen::MatrixXd at_rows, at_places;  ///< n×r, k×r [kg^-1/2]
};

struct ImaginaryParts {
  Eigen::MatrixXd mean, deviation;  ///< k×m [kg^-1/2], in the scale of the match; 0 of rigid modes
};

/// Damping C that couples the modes adds −jω_m C_mk / (ω_k² − ω_m²) of each other mode k to mode m.
/// C is positive semidefinite, so |C_mk|² ≤ 2ζ_m ω_m 2ζ_k ω_k. Within that bound nothing is known
/// of C_mk: the coefficients are normal with a variance of a third of the squared bound. They are
/// conditioned on the rows, whose shapes are known to 2 %. ζ_k is the mean of the fitted ratios.
/// Cost: n² (n + r) per mode.
/// @throws InvalidInput  the fit has no complex shapes, or sizes differ
[[nodiscard]] ImaginaryParts imaginary_parts(const ModalFit& fit, const GainMatch& match,
                                             const CouplingBasis& basis);

}  // namespace chladni::identification
