// A modal model fitted to measured responses, with standard deviations of all its parts.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "identification/fit_data.h"
#include "identification/likelihood/block_model.h"
#include "identification/likelihood/complex_shapes.h"
#include "modal/groups.h"
#include "modal/reduced_model.h"

namespace chladni::identification {

/// Start of a fit: n flexible modes as poles with residues, and the number of rigid-body modes at 0
/// Hz. G ≈ Σ residue_m / (s² − 2 Re(p_m) s + |p_m|²).
struct Start {
  Eigen::VectorXcd pole;                 ///< n [rad/s], Im > 0, Re < 0
  std::vector<Eigen::MatrixXd> residue;  ///< n, each p×q, of any rank. Empty: fitted to the data
  Eigen::Index rigid_count = 0;          ///< rank of the 1/s² term
  /// Complex modes of a fit with general damping: n, each p×q, X of X/(s − p) and its conjugate.
  /// Empty: fitted to the data. With them the two parts beside them:
  std::vector<Eigen::MatrixXcd> general;
  Eigen::MatrixXd rigid, constant;  ///< p×q: the factor of 1/s²; the residual
};

/// The flexible modes of a model, without residues.
[[nodiscard]] Start start_at(const modal::ReducedModel& model);

/// A modal model with its uncertainty.
/// G(s) = [Σ l_m r_m / (s² + 2 ζ_m ω_m s + ω_m²) + residual] e^{−sτ}; modes of frequency 0 first.
/// With general damping the modes are those of `complex`; the real shapes, deviations and
/// covariances below then belong to the real parts.
struct ModalFit {
  modal::ReducedModel model;        ///< output_shapes L p×m, input_shapes R m×q; residual p×q
  double delay_s = 0.0;             ///< mean over all channels where they have their own
  DelayOf delay_of = DelayOf::all;  ///< the channels of `channel_delay_s`
  Eigen::VectorXd channel_delay_s;  ///< p or q, added to delay_s; empty: one delay for all
  Eigen::VectorXd channel_delay_std_s;   ///< of delay_s + channel_delay_s; infinite: not measured
  std::optional<ComplexShapes> complex;  ///< where the damping is general

  Eigen::VectorXd frequency_std_hz, damping_std;  ///< m; 0 for rigid-body modes
  Eigen::MatrixXd output_std, input_std;  ///< of L and R; infinite if a channel is not measured
  Eigen::MatrixXd residual_std;           ///< p×q, for given modes
  double delay_std_s = 0.0;
  /// Covariance of (ω_m, ζ_m, L_m, R_m) per mode, (2+p+q) squared, in [rad/s], [1], units of L, R.
  /// The data give only the product of L_m and R_m: |L_m| = |R_m| fixes the scale, and the largest
  /// entry of L_m is positive, which fixes the sign. A damping that its bound holds has the
  /// variance that it would have without the bound, though damping_std is infinite: it is at most
  /// as far off.
  std::vector<Eigen::MatrixXd> mode_covariance;
  /// Covariance of (vec L_rb, vec R_rb) of all rigid-body modes together: their basis is free.
  Eigen::MatrixXd rigid_covariance;
  /// Modes of a group of two or more share a block: only the subspace of their shapes is known.
  std::vector<modal::ModeGroup> groups;

  double cost = 0.0;            ///< Σ |w (G − Ĝ)|²: half of χ² where the noise is known
  double expected_cost = 0.0;   ///< what noise alone leaves (identification::expected_cost)
  double cost_deviation = 0.0;  ///< one standard deviation of expected_cost
  Eigen::Index measured_count = 0, parameter_count = 0;
  int iterations = 0;
  bool converged = false;
  std::vector<std::string> notes;
  /// Those of `notes` that tell how the start was found: they hold for fits that go on from it, the
  /// others for this fit alone.
  std::vector<std::string> start_notes;

  [[nodiscard]] Eigen::Index flexible_count() const {
    return model.mode_count() - model.rigid_count;
  }
  /// Distance of the cost above what noise leaves, in deviations.
  [[nodiscard]] double excess() const { return (cost - expected_cost) / cost_deviation; }
  [[nodiscard]] Damping damping() const { return complex ? Damping::general : Damping::modal; }
};

/// The flexible modes of a fit. Complex shapes, the rigid-body part and the residual are kept with
/// them, so that a descent from here ends no higher than the fit, but for its delay.
[[nodiscard]] Start start_of(const ModalFit& fit);

/// noise_level of the fit's cost and parameters. It scales every deviation of the fit and sets the
/// gain in cost that a further mode or delay must reach.
[[nodiscard]] double noise_level(const ModalFit& fit, const FitData& data);

struct FitOptions {
  Damping damping = Damping::modal;
  bool residual = true;             ///< a constant p×q for the modes above the band
  bool delay = false;               ///< whether it is fitted
  DelayOf delay_of = DelayOf::all;  ///< one for all responses, or one for each output or input
  int iterations = 60;              ///< of Levenberg and Marquardt, at most
  bool keep_best = false;  ///< Ctrl-C stops the fit with the best so far (`converged` is false)
  Progress progress = {};
};

/// The same options for a fit whose poles are still to be chosen: Constants::first_iterations at
/// most.
[[nodiscard]] FitOptions first_fit_options(FitOptions options);

/// Real parameters of one flexible mode.
[[nodiscard]] Eigen::Index parameters_of_mode(const FitData& data, Damping damping);

/// Maximum likelihood from `start` by Levenberg and Marquardt
/// (docs/reference/identification.md). Modes closer than their half-power bandwidth are first
/// fitted as blocks, then separated where the data allow it. With general damping each mode has
/// complex shapes; blocks are only a step on the way.
/// @throws InvalidInput      start and data do not fit together, more parameters than numbers
/// @throws NumericalFailure  no step lowers the cost from the start
[[nodiscard]] ModalFit modal_fit(const FitData& data, const Start& start,
                                 const FitOptions& options = {});

/// pq: the delay of each response [s].
[[nodiscard]] Eigen::VectorXd response_delays(const ModalFit& fit);

/// The model's receptances on the data's lines, K×pq, delays included.
[[nodiscard]] Eigen::MatrixXcd responses(const ModalFit& fit, const Eigen::VectorXd& frequency_hz);

}  // namespace chladni::identification
