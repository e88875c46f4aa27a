// Every way to interpolate, one line each; interpolator.cpp lists them.
#pragma once

#include "priors/interpolator.h"

namespace chladni::priors {

extern const Interpolator dynamic_residual_interpolator;
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

}  // namespace chladni::priors
