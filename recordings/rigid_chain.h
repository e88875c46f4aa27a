// A beam as a chain of rigid bodies on revolute joints: the thesis' simulated beam (2.2.2).
//
// An independent simulator: it shares no code with the finite elements nor with the fit. Motion is
// small and transverse. The generalised coordinates are the displacements of the ends of the
// bodies, then the displacements of the carried bodies.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "modal/frf.h"
#include "modal/reduced_model.h"

namespace chladni::recordings {

struct RigidChain {
  double length_m = 0.5, width_m = 0.02, thickness_m = 0.002;  ///< of the strip
  double youngs_modulus = 210e9;                               ///< [Pa]
  double density = 7850.0;                                     ///< [kg/m^3]
  Eigen::Index bodies = 50;

  /// A coil or a sensor's target: a point mass that moves with the strip.
  struct Mass {
    double at_m = 0.0, mass_kg = 0.0;
  };
  std::vector<Mass> masses;
  /// A body on its own spring and dashpot.
  struct Carried {
    double at_m = 0.0, mass_kg = 0.0;
    double frequency_hz = 0.0;  ///< of this body on a strip at rest
    double damping_ratio = 0.0;
  };
  std::vector<Carried> carried;

  /// Wire flexures hold the strip at this distance from both its ends. Their stiffness against
  /// displacement and rotation gives the two lowest modes. Both frequencies 0: no flexures.
  double flexure_m = 0.01;
  double sway_hz = 2.5, turn_hz = 5.0;
  /// Damping ratio of both modes, by dashpots in the flexures and drag along the strip. They couple
  /// the modes a little.
  double suspension_damping_ratio = 0.02;
  /// Damping ratio of the first flexible mode, by joint dashpots in proportion to stiffness.
  double joint_damping_ratio = 0.005;
};

/// Five coils of 29.33 g at 50, 150, 250, 350 and 450 mm give 2.5, 5, 32.7, 89.7, 177.9 Hz. The
/// measured 32.75, 93, 183.75 Hz of the rig are near; a bare strip has 42.5, 117.2, 229.8 Hz.
[[nodiscard]] RigidChain beam_with_coils();

/// Coils of 27.24 g and a carried body of 20 g at 150 mm give 2.5, 5, 32.7, 51.9, 93.6, 181.2 Hz.
/// The thesis found the mode at 51.9 Hz; a strip alone does not have it.
[[nodiscard]] RigidChain beam_with_carried_body();

/// n generalised coordinates. M ẍ + C ẋ + K x = f.
struct ChainMatrices {
  Eigen::MatrixXd mass, damping, stiffness;  ///< n×n
  double body_length_m = 0.0;
  Eigen::Index bodies = 0;
  double sway_stiffness = 0.0, turn_stiffness = 0.0;  ///< of each flexure [N/m], [N m/rad]
};

/// @throws InvalidInput      a dimension is not positive, fewer than 3 bodies, a place off the
///                           strip
/// @throws NumericalFailure  no flexures give the two frequencies (turn_hz too low beside sway_hz)
///                           or the two damping ratios
[[nodiscard]] ChainMatrices matrices(const RigidChain& chain);

/// Rows that give the displacement at places along the strip: places×n.
/// @throws InvalidInput  a place is off the strip
[[nodiscard]] Eigen::MatrixXd displacement_rows(const ChainMatrices& chain,
                                                const Eigen::VectorXd& at_m);

/// The lowest modes as real modes, each with its projected damping (φᵀCφ). The other modes give the
/// residual flexibility. Without flexures two rigid-body modes at 0 Hz come first.
/// @throws InvalidInput  places off the strip, fewer than 1 mode or more than the chain has
[[nodiscard]] modal::ReducedModel reduced_model(const ChainMatrices& chain,
                                                const Eigen::VectorXd& sensors_m,
                                                const Eigen::VectorXd& actuators_m,
                                                Eigen::Index modes);

/// (K + jωC − ω²M)⁻¹ between places: exact, with the full damping matrix. Cost: n³ per line.
/// @throws InvalidInput  places off the strip, a frequency negative, or 0 without flexures
[[nodiscard]] modal::Frf frf(const ChainMatrices& chain, const Eigen::VectorXd& sensors_m,
                             const Eigen::VectorXd& actuators_m,
                             const Eigen::VectorXd& frequency_hz);

}  // namespace chladni::recordings
