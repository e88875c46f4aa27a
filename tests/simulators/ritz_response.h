// What hangs on a Ritz plate or carries it, and the responses of all of it together.
#pragma once

#include <complex>
#include <optional>

#include "simulators/ritz_plate.h"

namespace chladni::simulators {

/// At one place: a mass with a rotary inertia that follows the slopes of the surface, a spring and
/// a dashpot to ground.
struct RitzPoint {
  Eigen::Vector2d place;
  double mass = 0.0, rotary_inertia = 0.0;  ///< [kg], [kg m²] about x and y
  double stiffness = 0.0, damping = 0.0;    ///< [N/m], [N s/m]
};

/// A mass on a spring and a dashpot, moving along z.
struct RitzResonator {
  Eigen::Vector2d place;
  double mass = 0.0, frequency_hz = 0.0, damping_ratio = 0.0;  ///< of itself on a rigid base
};

/// Springs to ground, evenly spread over what of a disc lies on the plate.
struct RitzPad {
  Eigen::Vector2d centre;
  double radius = 0.0;
  double stiffness = 0.0;  ///< of all of it [N/m]
};

/// A support on springs of its own that the forces react on and the sensors stand on. It moves
/// along z and does not touch the plate.
struct RitzFrame {
  double mass = 0.0, frequency_hz = 0.0, damping_ratio = 0.0;
};

/// In the coordinates of the plate's modes. Time goes as e^{+jωt}: K + j loss + jω viscous.
struct RitzDamping {
  Eigen::MatrixXd viscous;  ///< n×n [1/s]
  Eigen::MatrixXd loss;     ///< n×n [1/s²]; 0×0: none
};
/// diag 2 ζ_k ω_k, ζ_k = ratio (f_k / reference_hz)^exponent.
[[nodiscard]] RitzDamping modal_damping(const RitzModes& modes, double ratio, double exponent = 0.0,
                                        double reference_hz = 1.0);
/// Loss diag 2 ζ ω_k²: as much at resonance.
[[nodiscard]] RitzDamping hysteretic_damping(const RitzModes& modes, double ratio);
/// That of another plate of the same basis and shape, as a matrix that does not change with the
/// plate: M₀ Φ₀ D Φ₀ᵀ M₀ seen by `modes`; its fields are stretched where one plate is larger.
/// @throws InvalidInput  the bases differ, or length over width
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

/// Where and when: outputs p×2, inputs q×2 [m], k lines.
struct RitzGrid {
  Eigen::MatrixX2d outputs, inputs;
  Eigen::VectorXd frequency_hz;
  /// p×2, q×2: of the channels, from upright toward x and y [rad]; 0×2: none.
  Eigen::MatrixX2d output_tilts = Eigen::MatrixX2d(0, 2), input_tilts = Eigen::MatrixX2d(0, 2);
  double output_height = 0.0, input_height = 0.0;  ///< above the mid-surface [m]
};

/// [k], each p×q [m/N]: everything assembled to one mass and one stiffness matrix, solved for its
/// own modes; damping between those below six times the last line (40 at least) is exact, that of
/// the others is taken on the diagonal; dashpots are exact.
/// Cost: n³ once with attachments (0.5 s for degree 14), 0.1 ms to 1 ms per line.
/// @throws InvalidInput  a place off the plate; a negative mass, stiffness or damping; 0 Hz
[[nodiscard]] std::vector<Eigen::MatrixXcd> ritz_receptance(const RitzStage& stage,
                                                            const RitzGrid& grid);

/// The same by the inverse of the whole dynamic stiffness on every line. Cost: n³ per line.
[[nodiscard]] std::vector<Eigen::MatrixXcd> direct_receptance(const RitzStage& stage,
                                                              const RitzGrid& grid);

/// Frequencies without damping, all of them, ascending; rigid-body modes only nearly 0.
[[nodiscard]] Eigen::VectorXd stage_frequencies_hz(const RitzStage& stage);

}  // namespace chladni::simulators
