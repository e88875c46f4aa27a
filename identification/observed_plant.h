// An identified model with further outputs, points that no sensor sees, and further inputs, forces
// that nobody measures: what an observer is designed on.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identification/gain_match.h"
#include "identification/modal_fit.h"
#include "identification/spatio_temporal.h"
#include "modal/control_model.h"

namespace chladni::identification {

/// What an observer's model has beside the sensors and actuators of the fit.
struct ObservedPlaces {
  std::vector<std::string> points;  ///< names of the points of interest
  PlacesOfInterest at_points;       ///< their shapes and residual
  std::vector<std::string> forces;  ///< names of forces at places without an actuator
  PlacesOfInterest at_forces;       ///< their shapes; their direct flexibility is not known: 0
  /// m: Γ with Σ φ_m Γ_m = 1 along z, so that an acceleration a of the floor is the modal force
  /// −Γ a, motion being relative to the floor; or empty
  Eigen::VectorXd floor;
};

/// Inputs: the actuators, the forces, then the floor (m/s²). Outputs: the sensors in their own
/// quantities, then displacements of the points. States, scale and delays as in control_model;
/// delays are those of the actuators and sensors, points have none of their own.
/// @throws InvalidInput  sizes differ; a floor that moves beside a sensor of velocity or
///                       acceleration, which does not stand on it
[[nodiscard]] modal::ControlModel observed_plant(const ModalFit& fit, const GainMatch& match,
                                                 const std::vector<modal::MeasuredChannel>& outputs,
                                                 const std::vector<modal::MeasuredChannel>& inputs,
                                                 const ObservedPlaces& places);

/// Γ of the modes in which the body moves as a whole, by least squares over the rows of the match;
/// 0 of all others. Channels that were not measured take no part. Empty where there are no such
/// modes or the channels do not tell them.
/// @param rigid  modes in which the body moves as a whole
/// @param along  n_z: the part of each row's direction that is along z
[[nodiscard]] Eigen::VectorXd floor_participation(const GainMatch& match,
                                                  const std::vector<Eigen::Index>& rigid,
                                                  const Eigen::VectorXd& along);

}  // namespace chladni::identification
