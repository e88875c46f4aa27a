// One scale for both sides of a modal model: what actuators say of the shapes joins the sensors.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "identification/gains/rigid_body.h"
#include "identification/modal_fit.h"
#include "modal/frf_set.h"
#include "priors/gain.h"

namespace chladni::identification {

/// A sensor and an actuator at one place, or near each other (thesis 6.2.1: 100 mm apart).
struct CollocatedPair {
  Eigen::Index output = 0, input = 0;
  /// Shapes of a simulation at both places, m entries each in the order of the fit's modes. Empty:
  /// it is one place. Else the two keep a row each.
  Eigen::VectorXd at_output, at_input;

  [[nodiscard]] bool is_one_place() const { return at_output.size() == 0 && at_input.size() == 0; }
};

/// Each output with the nearest input within `within_m`, no channel twice, the nearest first.
/// Channels without a position take no part.
[[nodiscard]] std::vector<CollocatedPair> collocated_pairs(
    const std::vector<modal::MeasuredChannel>& outputs,
    const std::vector<modal::MeasuredChannel>& inputs, double within_m);

enum class GainRule {
  /// α⁴ = Σ L² / Σ R² over the pairs (5.5); rows of L stay as they are. The thesis'.
  thesis,
  /// The likeliest L, R and α that agree at the pairs, with the covariance of the fit: all rows of
  /// the mode move. To first order what a fit with L_c = R_c tied gives.
  tied,
};

/// Which side of a pair is corrected by its gain ratio.
enum class GainFault { nobody, outputs, inputs };

/// Where the channels are, for motions as a whole.
struct RigidGeometry {
  Eigen::MatrixXd outputs, inputs;      ///< p×r, q×r, as rigid_directions gives them
  std::vector<Eigen::Index> suspended;  ///< modes above 0 Hz that move (nearly) as a rigid body
  double bending = 0.0;      ///< of those: deviation from rigid motion, a part of the shape's rms
  bool pairs_first = false;  ///< the motion tells only those modes that no pair does
};

/// What a simulation says, for modes that no pair tells (priors/gain.h).
struct GainPrior {
  priors::Places outputs, inputs;
  priors::ModalBasis basis;
  priors::DynamicResidual residual;
};

struct GainMatchOptions {
  std::vector<CollocatedPair> pairs;
  GainRule rule = GainRule::tied;
  GainFault fault = GainFault::nobody;
  double significance = 3.0;      ///< a pair tells a mode where |L_c R_c| is so many deviations
  double simulation_error = 0.1;  ///< at either place of a near pair, of the change
  std::optional<RigidGeometry> geometry;
  std::optional<GainPrior> prior;
};

/// By what the scale of a mode was found.
enum class MatchedBy { pairs, geometry, prior, nothing };

/// φ = L/α at the sensors and ± α R at the actuators. Of blocks and 0 Hz modes α is 1: more than a
/// scale relates the two sides.
struct ModeMatch {
  MatchedBy by = MatchedBy::nothing;
  double alpha = 1.0, alpha_std = 0.0;
  int sign = 1;               ///< −1: the two sides count in opposite directions
  double disagreement = 0.0;  ///< χ² of the pairs (or places) beyond what α needs
  Eigen::Index freedoms = 0;  ///< its degrees of freedom
};

/// Gain of the sensor over that of the actuator, up to one factor for all pairs (their mean ln is
/// 0).
struct PairGain {
  double ratio = 1.0, ratio_std = 0.0;
  bool turned = false;     ///< one of the two counts against the direction of the others
  Eigen::Index modes = 0;  ///< that tell the ratio; below 1 or with one pair only it is 1
};

/// A row of the extended output matrix.
struct MatchedRow {
  bool actuator = false;
  Eigen::Index channel = 0;
};

/// Mass-normalised shapes at all places, n_z = n_s + n_a − n_c of them (5.2): all sensors, then the
/// actuators that share no place with one. Modes in the order of the fit.
struct GainMatch {
  std::vector<ModeMatch> modes;     ///< m
  std::vector<PairGain> pairs;      ///< as in the options
  std::vector<MatchedRow> rows;     ///< n_z
  Eigen::MatrixXd shapes;           ///< n_z×m [kg^-1/2]
  Eigen::MatrixXd deviation;        ///< n_z×m; infinite where a mode was matched by nothing: its
                                    ///< shape then has the same rms on both sides, a guess
  Eigen::MatrixXd input_shapes;     ///< m×q [kg^-1/2], all actuators: what goes with `shapes`
  Eigen::MatrixXd input_deviation;  ///< m×q
  /// Im of complex shapes at the rows and for the actuators, n_z×m and m×q; empty of real ones. The
  /// phase between both sides is that at which the pairs agree.
  Eigen::MatrixXd imaginary, imaginary_deviation, input_imaginary;
  std::optional<RigidBody> rigid;  ///< from the modes at 0 Hz, where the geometry is given
  std::vector<std::string> warnings;
};

/// @param outputs, inputs  the channels, for their names
/// Cost: (p + q)² per mode and block.
/// @throws InvalidInput  sizes differ, a pair names a channel that is not there or one twice
[[nodiscard]] GainMatch gain_match(const ModalFit& fit,
                                   const std::vector<modal::MeasuredChannel>& outputs,
                                   const std::vector<modal::MeasuredChannel>& inputs,
                                   const GainMatchOptions& options);

/// The modal model from the actuators to all n_z places. The residual is known only at the sensors.
[[nodiscard]] modal::ReducedModel extended_model(const ModalFit& fit, const GainMatch& match);

}  // namespace chladni::identification
