// The loop of a virtual experiment: what keeps a free body in its place while it is shaken.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identification/experiment/plant.h"
#include "modal/reduced_model.h"

namespace chladni::identification {

/// x⁺ = A x + B y, u = C x + D y once per sample, from all sensors to the controlled actuators.
struct Controller {
  Eigen::MatrixXd a, b, c, d;
  std::vector<Eigen::Index> controlled;  ///< inputs of the plant, one per row of c
};

/// The model without the rigid-body modes that no output sees: those of a free body seen along z
/// only are three; the others are rotated so that they stay of unit mass.
/// @throws InvalidInput  the model does not fit together
[[nodiscard]] modal::ReducedModel in_view(const modal::ReducedModel& model);

/// One loop for each of the lowest `axes` modes: sensors and actuators decoupled by the
/// pseudoinverse of their shapes; in each axis an integrator to a tenth of the bandwidth, a lead
/// from a third to three times it and a second-order roll-off at eight times; Tustin's rule.
/// @throws InvalidInput  fewer controlled actuators or sensors than axes, or blind ones; a
/// bandwidth
///                       above a tenth of the sampling frequency
[[nodiscard]] Controller stabiliser(const modal::ReducedModel& model, Eigen::Index axes,
                                    const std::vector<Eigen::Index>& controlled,
                                    double bandwidth_hz, double sample_time_s);

/// Largest magnitude of the eigenvalues of the loop with a delay of whole samples (1 or more) and a
/// fraction: below 1 it is stable. Cost: cubic in all states.
[[nodiscard]] double largest_eigenvalue(const Plant& plant, const Controller& controller,
                                        double sample_time_s, double delay_s);

}  // namespace chladni::identification
