// A modal model fitted to measured responses, with the deviations of all it consists of.
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

/// Where a fit starts: n flexible modes as poles with residues, and how many rigid-body modes there
/// are at 0 Hz. G ≈ Σ residue_m / (s² − 2 Re(p_m) s + |p_m|²).
struct Start {
  Eigen::VectorXcd pole;                 ///< n [rad/s], Im > 0, Re < 0
  std::vector<Eigen::MatrixXd> residue;  ///< n, each p×q; any rank. Empty: fitted to the data
  Eigen::Index rigid_count = 0;          ///< rank of the 1/s² term
};

/// The flexible modes of a model, without residues.
[[nodiscard]] Start start_at(const modal::ReducedModel& model);

/// A modal model and how sure it is.
/// G(s) = [Σ l_m r_m / (s² + 2 ζ_m ω_m s + ω_m²) + residual] e^{−sτ}; modes of frequency 0 first.
/// Of a fit with general damping the modes are those of `complex`; real shapes, their deviations
/// and covariances here are of the real parts then.
struct ModalFit {
  modal::ReducedModel model;        ///< output_shapes L p×m, input_shapes R m×q; residual p×q
  double delay_s = 0.0;             ///< the mean of all channels' where they have their own
  DelayOf delay_of = DelayOf::all;  ///< whose `channel_delay_s` are
  Eigen::VectorXd channel_delay_s;  ///< p or q, of each on top of delay_s; empty: one for all
  Eigen::VectorXd channel_delay_std_s;   ///< of delay_s + channel_delay_s; infinite: not measured
  std::optional<ComplexShapes> complex;  ///< where the damping is general

  Eigen::VectorXd frequency_std_hz, damping_std;  ///< m; 0 for rigid-body modes
  Eigen::MatrixXd output_std, input_std;  ///< of L and R; infinite of channels not measured at all
  Eigen::MatrixXd residual_std;           ///< p×q, the modes being given
  double delay_std_s = 0.0;
  /// Covariance of (ω_m, ζ_m, L_m, R_m) per mode, (2+p+q) squared, in [rad/s], [1], units of L, R.
  /// The data know only the product of L_m and R_m: the scale is fixed by |L_m| = |R_m|, the sign
  /// by the largest entry of L_m being positive.
  std::vector<Eigen::MatrixXd> mode_covariance;
  /// Covariance of all rigid-body modes' (vec L_rb, vec R_rb) together: their basis is free.
  Eigen::MatrixXd rigid_covariance;
  /// Modes of a group of more than one share a block: only the subspace of their shapes is known.
  std::vector<modal::ModeGroup> groups;

  double cost = 0.0;            ///< Σ |w (G − Ĝ)|²: half of χ² where the noise is known
  double expected_cost = 0.0;   ///< what noise alone leaves (identification::expected_cost)
  double cost_deviation = 0.0;  ///< of that, one standard deviation
  Eigen::Index measured_count = 0, parameter_count = 0;
  int iterations = 0;
  bool converged = false;
  std::vector<std::string> notes;

  /// By how many deviations the cost is above what noise leaves.
  [[nodiscard]] double excess() const { return (cost - expected_cost) / cost_deviation; }
  [[nodiscard]] Damping damping() const { return complex ? Damping::general : Damping::modal; }
};

/// noise_level of the fit's cost and parameters: what every deviation of the fit is scaled with,
/// and what a further mode or delay has to be worth.
[[nodiscard]] double noise_level(const ModalFit& fit, const FitData& data);

struct FitOptions {
  Damping damping = Damping::modal;
  bool residual = true;             ///< a constant p×q for the modes above the band
  bool delay = false;               ///< fitted
  DelayOf delay_of = DelayOf::all;  ///< one for all responses, or of each output or input its own
  int iterations = 60;              ///< of Levenberg and Marquardt, at most
  bool keep_best = false;  ///< Ctrl-C stops the fit with the best so far (`converged` is false)
  Progress progress = {};
};

/// Maximum likelihood by Levenberg and Marquardt from `start` (docs/reference/identification.md).
/// Modes nearer to each other than their half-power bandwidth are fitted as blocks and told apart
/// afterwards where the data can. With general damping each mode has complex shapes, blocks only
/// lead to them.
/// @throws InvalidInput      start and data do not fit together, more parameters than numbers
/// @throws NumericalFailure  no step lowers the cost from the start
[[nodiscard]] ModalFit modal_fit(const FitData& data, const Start& start,
                                 const FitOptions& options = {});

/// pq: the delay of each response [s].
[[nodiscard]] Eigen::VectorXd response_delays(const ModalFit& fit);

/// The model's receptances on the data's lines, K×pq, delays included.
[[nodiscard]] Eigen::MatrixXcd responses(const ModalFit& fit, const Eigen::VectorXd& frequency_hz);

}  // namespace chladni::identification
