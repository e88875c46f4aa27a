// What a fit will know of the modes, before anything is measured.
#pragma once

#include <Eigen/Core>

#include "identification/modal_fit.h"
#include "modal/reduced_model.h"

namespace chladni::identification {

/// The Cramér-Rao bound of a modal model: the deviations that modal_fit states for responses of
/// the model itself with these variances. Residual and delay count as unknown, as in a fit of
/// measured data. Cost: that of a fit of some hundred lines around each mode, and K; lines between
/// which nothing changes count as one.
/// @param model     p×q, without modes that no channel sees. Dashpots are left out: state their
///                  part as damping ratios (with_dashpots_as_ratios)
/// @param line_hz   K, ascending, above 0
/// @param variance  K×pq, E|G − G₀|² of each receptance; response (i, j) is column i + p j
/// @throws InvalidInput  sizes differ, a variance is not positive, more parameters than numbers, as
///                       modal_fit
[[nodiscard]] ModalFit expected_fit(const modal::ReducedModel& model,
                                    const Eigen::VectorXd& line_hz,
                                    const Eigen::MatrixXd& variance);

/// The same modes with the damping that dashpots add to each of them alone, φᵀCφ / 2ω, and without
/// dashpots. Their coupling of the modes is left out.
[[nodiscard]] modal::ReducedModel with_dashpots_as_ratios(const modal::ReducedModel& model);

/// Some modes (ascending columns), and all of the residual. Rigid-body modes stay first.
[[nodiscard]] modal::ReducedModel with_modes(const modal::ReducedModel& model,
                                             const std::vector<Eigen::Index>& modes);

}  // namespace chladni::identification
