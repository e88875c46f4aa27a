// Input: measured responses. Output: a modal model; the number of modes is found.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identification/fit_data.h"
#include "identification/modal_fit.h"
#include "identification/poles/drift.h"

namespace chladni::identification {

struct IdentificationOptions {
  Eigen::Index modes = 0;        ///< flexible modes; 0: found
  Eigen::Index rigid_count = 0;  ///< modes at 0 Hz: the rank of the term in 1/s²; −1: found
  Eigen::Index most_rigid = 6;   ///< largest number that the search may find
  /// Springs hold the body, and rigid_count is 0: where the lines begin far above the modes of this
  /// suspension, these are fitted as modes at 0 Hz, if the data need them.
  bool on_springs = false;
  Eigen::Index most_modes = 80;
  /// Whether a further mode may lie far beyond the lines. Such modes stand for a suspension, a
  /// frame and what is above; the data do not determine their residues.
  bool far_modes = false;
  bool drift = true;  ///< search for drift where no variance is stated
  FitOptions fit = {};
};

/// The result of one attempt to add or remove a mode.
struct OrderStep {
  Eigen::Index modes = 0;  ///< flexible modes
  double cost = 0.0;       ///< Σ |w error|²
  double excess = 0.0;     ///< ModalFit::excess
  bool taken = false;
};

struct Identified {
  ModalFit fit;
  std::vector<OrderStep> steps;
  Eigen::Index start_order = 0;  ///< order of the vector fit
  std::optional<Drift> drift;    ///< present if it matters: the fit is of data without it
};

/// First, vector fitting of an order above the number of visible resonances finds poles, and poles
/// that are not worth their parameters are left out. Then maximum likelihood fits the rest. While
/// more than noise is left, the mode that explains most of it is added and kept if the Bayesian
/// information criterion accepts it.
/// Where the noise is not known, the residual of the fit gives its level, and a further mode must
/// lower the cost by 2 %; beside a stated model error by 2 % of the part that this error may leave
/// (FitData::error_share). With general damping the delay is that of real modes unless the data
/// require another: a delay and the phases of complex modes are hardly distinguishable, and the
/// deviation of the delay states this. Where no variance is stated, resonances that differ in
/// frequency between responses are aligned first (drift.h); else each would become several modes.
/// @throws InvalidInput  as modal_fit; nothing in the data stands out of the noise
[[nodiscard]] Identified identified(const FitData& data, const IdentificationOptions& options = {});

/// pq [s]: the delay of each response before any fit. It is the delay at which real residues at the
/// poles of a vector fit fit best. Where the phases alone ask for one near the end of the scan or
/// beyond it (phase_delays), poles are also sought without that one, and the better result counts.
/// It may be off by periods where modes overlap. One output, one input or all responses share one
/// delay, as options.fit.delay_of says. Zeros where options.fit.delay is false.
/// @throws as vector_fit
[[nodiscard]] Eigen::VectorXd delays_at_start(const FitData& data,
                                              const IdentificationOptions& options);

/// The same modes, fitted again to data with other weights.
/// @param data  has the channels of `fit`
/// @throws as modal_fit
[[nodiscard]] ModalFit refitted(const FitData& data, const ModalFit& fit,
                                const FitOptions& options = {});

/// Fits the modes again, and a delay with them, to the same data. Their delay was taken out by a
/// first estimate, and `fit` has none. The result replaces `fit` if it lowers the cost by more than
/// five deviations, where the model's own error counts in the noise level. Else `fit` stays and
/// only takes the deviation of the delay. Of its notes a new fit takes over those of the start.
/// @param options  with `delay`
/// @throws as modal_fit
void free_delay(const FitData& data, const FitOptions& options, ModalFit& fit);

/// Puts the modes and the residual of `from` into `into`, whose deviations stay; both have the same
/// modes. Shapes get the sign that they had in `into` where its deviations are finite. Complex
/// shapes stay.
void take_values(const ModalFit& from, ModalFit& into);

/// Poles of vector fits of rising order, for the usual stabilisation diagram.
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
