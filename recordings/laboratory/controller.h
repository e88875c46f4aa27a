// The loop of a virtual experiment: it holds a free body in place during the excitation.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "modal/reduced_model.h"
#include "recordings/laboratory/plant.h"

namespace chladni::recordings {

/// x⁺ = A x + B y, u = C x + D y once per sample. y are all sensors, u the controlled actuators.
struct Controller {
  Eigen::MatrixXd a, b, c, d;
  std::vector<Eigen::Index> controlled;  ///< inputs of the plant, one per row of c
};

/// The model without the rigid-body modes that no output sees. (A free body that is seen only along
/// z keeps three.) The others are rotated; they keep unit modal mass.
/// @throws InvalidInput  the model does not fit together
[[nodiscard]] modal::ReducedModel in_view(const modal::ReducedModel& model);

/// One loop for each of the lowest `axes` modes. The pseudoinverses of their shapes decouple
/// sensors and actuators. Each axis has an integrator up to a tenth of the bandwidth, a lead from a
/// third to three times the bandwidth and a second-order roll-off at eight times it. Tustin's rule
/// makes it discrete.
/// @throws InvalidInput  fewer controlled actuators or sensors than axes, or channels that do not
///                       see every axis on its own; a bandwidth above a tenth of the sampling
///                       frequency
[[nodiscard]] Controller stabiliser(const modal::ReducedModel& model, Eigen::Index axes,
                                    const std::vector<Eigen::Index>& controlled,
                                    double bandwidth_hz, double sample_time_s);

/// Largest magnitude of the eigenvalues of the loop, with a delay of whole samples (1 or more) and
/// a fraction. The loop is stable if it is below 1. Cost: cubic in the number of all states.
[[nodiscard]] double largest_eigenvalue(const Plant& plant, const Controller& controller,
                                        double sample_time_s, double delay_s);

}  // namespace chladni::recordings
