// What a real structure or channel may deviate without that being an effect.
#pragma once

namespace chladni::diagnosis {

/// Standard deviations, SI. Every parameter of an effect has its twin here: what stays within a few
/// of these is never named. 0: known exactly.
struct Tolerances {
  double gain = 5e-3;         ///< of each channel, relative
  double position = 5e-4;     ///< [m], of each channel along each axis
  double delay = 1e-6;        ///< [s], common to all
  double modulus = 5e-3;      ///< of the whole body, relative
  double density = 3e-3;      ///< likewise
  double thickness = 1.5e-3;  ///< relative, of each smooth wave over the body and of the whole
  double orthotropy = 5e-3;   ///< of one direction's stiffness, relative
  /// Of each mode: what solver and theory leave, beside what its mesh does
  /// (Structure::frequency_error).
  double frequency = 1e-3;
  double damping = 0.2;  ///< of each mode, of the logarithm
  /// Of the definition of the study's damping ratios: 0 where they are those of the modes of its
  /// body as it is, 1 where they may as well be those of the modes with what turns out to hang on
  /// it (loaded_damping.h).
  double loaded_damping = 1.0;
  /// Of each response, relative to what its channels respond at that frequency: errors of the mode
  /// shapes that mesh and theory leave. It widens the noise.
  double response = 1e-3;
  /// Of what the modes above those in use yield, relative: where a force acts that depends on the
  /// mesh.
  double residual = 0.2;
  double scale = 0.0;  ///< of all responses together, of the logarithm
  /// [kg], of what each sensor (each actuator) weighs beside the model, all of a side alike:
  /// cables, glue, and what the mesh makes of a place.
  double mass = 2e-3;
};

/// Nothing may deviate.
[[nodiscard]] inline Tolerances no_tolerances() {
  return {.gain = 0.0,
          .position = 0.0,
          .delay = 0.0,
          .modulus = 0.0,
          .density = 0.0,
          .thickness = 0.0,
          .orthotropy = 0.0,
          .frequency = 0.0,
          .damping = 0.0,
          .loaded_damping = 0.0,
          .response = 0.0,
          .residual = 0.0,
          .scale = 0.0,
          .mass = 0.0};
}

/// All but nothing: data made by the very model that is diagnosed.
[[nodiscard]] inline Tolerances exact_model() {
  return {.gain = 1e-5,
          .position = 1e-6,
          .delay = 1e-9,
          .modulus = 1e-5,
          .density = 1e-5,
          .thickness = 1e-5,
          .orthotropy = 1e-5,
          .frequency = 1e-6,
          .damping = 1e-4,
          .loaded_damping = 0.0,
          .response = 0.0,
          .residual = 1e-5,
          .scale = 0.0,
          .mass = 1e-8};
}

}  // namespace chladni::diagnosis
