// Attachments and supports of a Ritz plate, and the responses of the whole stage.
#pragma once

#include <complex>
#include <optional>

#include "simulators/plates/ritz_plate.h"

namespace chladni::simulators {

/// Attachments at one place: a mass with a rotary inertia that follows the slopes of the surface, a
/// spring and a dashpot to ground.
struct RitzPoint {
  Eigen::Vector2d place;
  double mass = 0.0, rotary_inertia = 0.0;  ///< [kg], [kg m²] about x and y
  double stiffness = 0.0, damping = 0.0;    ///< [N/m], [N s/m]
};

/// A mass on a spring and a dashpot that moves along z.
struct RitzResonator {
  Eigen::Vector2d place;
  double mass = 0.0, frequency_hz = 0.0, damping_ratio = 0.0;  ///< of the resonator on a rigid base
};

/// Springs to ground, evenly spread over the part of a disc on the plate.
struct RitzPad {
  Eigen::Vector2d centre;
  double radius = 0.0;
  double stiffness = 0.0;  ///< total [N/m]
};

/// A support on its own springs. It carries the reaction forces and the sensors, moves along z and
/// does not touch the plate.
struct RitzFrame {
  double mass = 0.0, frequency_hz = 0.0, damping_ratio = 0.0;
};

/// Damping in the coordinates of the plate's modes: K + j loss + jω viscous, with time as e^{+jωt}.
struct RitzDamping {
  Eigen::MatrixXd viscous;  ///< n×n [1/s]
  Eigen::MatrixXd loss;     ///< n×n [1/s²]; 0×0: none
};
/// Viscous damping diag 2 ζ_k ω_k with ζ_k = ratio (f_k / reference_hz)^exponent.
[[nodiscard]] RitzDamping modal_damping(const RitzModes& modes, double ratio, double exponent = 0.0,
                                        double reference_hz = 1.0);
/// Loss diag 2 ζ ω_k², which has the same effect at resonance.
[[nodiscard]] RitzDamping hysteretic_damping(const RitzModes& modes, double ratio);
/// The damping of another plate `from` with the same basis and shape, as a matrix that does not
/// change with the plate: M₀ Φ₀ D Φ₀ᵀ M₀ in the coordinates of `modes`. Its fields are stretched
/// where one plate is larger.
/// @throws InvalidInput  the bases or the ratios of length to width differ
[[nodiscard]] RitzDamping carried_over(const RitzDamping& damping, const RitzModes& from,
                                       const RitzModes& modes);

struct RitzStage {
  RitzModes plate;
  RitzDamping damping;
  std::vector<RitzPoint> points;
  std::vector<RitzResonator> resonators;
  std::vector<RitzPad> pads;
  std::optional<RitzFrame> frame;
};

/// Places and lines: outputs p×2, inputs q×2 [m], k lines.
struct RitzGrid {
  Eigen::MatrixX2d outputs, inputs;
  Eigen::VectorXd frequency_hz;
  /// p×2, q×2: tilts of the channels from upright toward x and y [rad]; 0×2: none.
  Eigen::MatrixX2d output_tilts = Eigen::MatrixX2d(0, 2), input_tilts = Eigen::MatrixX2d(0, 2);
  double output_height = 0.0, input_height = 0.0;  ///< above the mid-surface [m]
};

/// The receptances [k], each p×q [m/N]. The whole stage is assembled to one mass and one stiffness
/// matrix and solved for its modes. Damping between the modes below six times the last line (at
/// least 40 modes) is exact; of the other modes only the diagonal is used. Dashpots are exact.
/// Cost: n³ once with attachments (0.5 s for degree 14), 0.1 ms to 1 ms per line.
/// @throws InvalidInput  a place off the plate; a negative mass, stiffness or damping; 0 Hz
[[nodiscard]] std::vector<Eigen::MatrixXcd> ritz_receptance(const RitzStage& stage,
                                                            const RitzGrid& grid);

/// The receptances by the inverse of the whole dynamic stiffness on every line. Cost: n³ per line.
[[nodiscard]] std::vector<Eigen::MatrixXcd> direct_receptance(const RitzStage& stage,
                                                              const RitzGrid& grid);

/// All frequencies without damping, ascending. Rigid-body modes are only nearly at 0.
[[nodiscard]] Eigen::VectorXd stage_frequencies_hz(const RitzStage& stage);

}  // namespace chladni::simulators
