// All methods of interpolation; interpolator.cpp lists them.
#pragma once

#include "priors/interpolator.h"

namespace chladni::priors {

extern const Interpolator dynamic_residual_interpolator;
extern const Interpolator dynamic_residual_orthogonal_interpolator;
extern const Interpolator dynamic_residual_alone_interpolator;
extern const Interpolator energy_spline_interpolator;
extern const Interpolator strain_energy_spline_interpolator;
extern const Interpolator ensemble_interpolator;
extern const Interpolator modal_expansion_interpolator;
extern const Interpolator serep_interpolator;
extern const Interpolator thin_plate_spline_interpolator;
extern const Interpolator thin_plate_spline_gcv_interpolator;
extern const Interpolator thin_plate_spline_leave_one_out_interpolator;
extern const Interpolator surface_matern_interpolator;
extern const Interpolator squared_exponential_interpolator;
extern const Interpolator squared_exponential_per_mode_interpolator;
extern const Interpolator squared_exponential_symmetrised_interpolator;
extern const Interpolator squared_exponential_matched_interpolator;
extern const Interpolator squared_exponential_evidence_interpolator;
extern const Interpolator matern_5_2_interpolator;
extern const Interpolator matern_3_2_interpolator;

}  // namespace chladni::priors
