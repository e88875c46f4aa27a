// Nuisance tolerances: deviations of a real structure or channel that are not an effect.
#pragma once

namespace chladni::diagnosis {

/// Standard deviations, SI. A deviation within a few of these is never named. 0: known exactly. What
/// has none here is known exactly: a delay of one channel, low-passes, crosstalk, drift, suspension,
/// frame.
struct Tolerances {
  double gain = 5e-3;         ///< of each channel, relative
  double position = 5e-4;     ///< [m], of each channel along each axis
  double delay = 1e-6;        ///< [s], common to all
  double modulus = 5e-3;      ///< of the whole body, relative
  double density = 3e-3;      ///< likewise
  double thickness = 1.5e-3;  ///< relative, of the whole and of each smooth wave over the body
  double orthotropy = 5e-3;   ///< of one direction's stiffness, relative
  /// Each mode has this error of solver and theory, in addition to that of its mesh
  /// (Structure::frequency_error).
  double frequency = 1e-3;
  double damping = 0.2;  ///< of each mode, in ln
  /// Uncertain definition of the study's damping ratios. 0: they belong to the modes of its body as
  /// it is. 1: they may also belong to the modes with all attachments that a cause adds
  /// (loaded_damping.h).
  double loaded_damping = 1.0;
  /// Error of each response by the mode shapes (mesh and theory), relative to the level of its
  /// channels at that frequency. It widens the noise.
  double response = 1e-3;
  /// Relative error of the residual flexibility of the modes above. This flexibility depends on the
  /// mesh where a force acts.
  double residual = 0.2;
  double scale = 0.0;  ///< of all responses together, in ln
  /// [kg], mass of each sensor (each actuator) that the model lacks, the same for all of a side:
  /// cables, glue, and the error of the mesh at a place.
  double mass = 2e-3;
};

/// No deviations: everything is known exactly.
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

/// Almost no deviations: for data made by the same model that is diagnosed.
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
