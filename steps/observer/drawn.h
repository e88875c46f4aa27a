// Models drawn from what a fit and the shapes at points leave open.
#pragma once

#include <Eigen/Core>

#include "base/draw.h"
#include "identification/modal_fit.h"
#include "identification/observed_plant.h"
#include "steps/observer.h"

namespace chladni::steps {

/// Numbers of the fit and of the shapes at the points of which no deviation is known.
/// @param points  deviations, n×m
[[nodiscard]] Eigen::Index unknown_numbers(const IdentifiedModel& model,
                                           const Eigen::MatrixXd& points);

/// Poles and shapes of the modes as the fit leaves them open; the damping stays positive. An entry
/// of the covariance that is not known deviates by the size of its number. Modes beyond the lines
/// stay.
[[nodiscard]] identification::ModalFit drawn_fit(const IdentifiedModel& identified, Draw& draw);

/// The shapes at the points by their deviations, likewise. By as much as all shapes of a mode are
/// off in `drawn`, those at the points are too, as far as their deviation allows.
[[nodiscard]] identification::ObservedPlaces drawn_places(identification::ObservedPlaces places,
                                                          const Observer& observer,
                                                          const identification::ModalFit& drawn,
                                                          Draw& draw);

}  // namespace chladni::steps
