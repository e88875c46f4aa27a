// Measured responses in, modal model out: the number of modes is found.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identification/fit_data.h"
#include "identification/modal_fit.h"
#include "identification/poles/drift.h"

namespace chladni::identification {

struct IdentificationOptions {
  Eigen::Index modes = 0;        ///< flexible ones; 0: found
  Eigen::Index rigid_count = 0;  ///< modes at 0 Hz: the rank of the term in 1/s²; −1: found
  Eigen::Index most_rigid = 6;   ///< that may be found
  Eigen::Index most_modes = 80;
  bool drift = true;  ///< looked for where no variance is stated
  FitOptions fit = {};
};

/// What each attempt to add a mode came to.
struct OrderStep {
  Eigen::Index modes = 0;  ///< flexible ones
  double cost = 0.0;       ///< Σ |w error|²
  double excess = 0.0;     ///< ModalFit::excess
  bool taken = false;
};

struct Identified {
  ModalFit fit;
  std::vector<OrderStep> steps;
  Eigen::Index start_order = 0;  ///< of the vector fit
  std::optional<Drift> drift;    ///< where it matters: the fit is of the data without it
};

/// Poles by vector fitting of an order above the number of resonances seen, those that are not
/// worth their parameters left out; maximum likelihood; then, while more is left than noise, the
/// mode that explains most of it, kept where the Bayesian information criterion says so.
/// Where the noise is not known its level is what the fit leaves, and a further mode must lower the
/// cost by 2 %. With general damping the delay is that of real modes unless the data ask for
/// another: phases of complex modes can hardly be told from a delay, which is what its deviation
/// says. Where no variance is stated, resonances that lie elsewhere in other responses are brought
/// together first (drift.h): else each would be several modes.
/// @throws InvalidInput  as modal_fit; nothing in the data stands out of the noise
[[nodiscard]] Identified identified(const FitData& data, const IdentificationOptions& options = {});

/// pq [s]: the delay of each response before anything is fitted, that under which real residues at
/// the poles of a vector fit fit best; those of one output or input (or all) having one, as
/// options.fit.delay_of says. Zeros where options.fit.delay is false.
/// @throws as vector_fit
[[nodiscard]] Eigen::VectorXd delays_at_start(const FitData& data,
                                              const IdentificationOptions& options);

/// The same modes with the data weighted otherwise.
/// @param data  of the channels that `fit` is of
/// @throws as modal_fit
[[nodiscard]] ModalFit refitted(const FitData& data, const ModalFit& fit,
                                const FitOptions& options = {});

/// The modes and the residual of one fit, with the deviations of the other, whose modes they are:
/// in `into`, shapes turned as they were there. Complex shapes stay.
void take_values(const ModalFit& from, ModalFit& into);

/// Poles of vector fits of rising order, for the diagram that users know.
struct StabilisationPoint {
  Eigen::Index order = 0;
  double frequency_hz = 0.0, damping_ratio = 0.0;
  bool stable_frequency = false, stable_damping = false,
       stable_shape = false;  ///< 0.1 %, 5 %, MAC 0.98
};
[[nodiscard]] std::vector<StabilisationPoint> stabilisation(const FitData& data,
                                                            Eigen::Index highest_order, bool rigid,
                                                            const Progress& progress = {});

}  // namespace chladni::identification
