// One scale for both sides of a modal model: the actuators' shape values join the sensors'.
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

/// A sensor and an actuator at one place, or close to each other (thesis 6.2.1: 100 mm apart).
struct CollocatedPair {
  Eigen::Index output = 0, input = 0;
  /// Shapes of a simulation at both places, m entries each in the order of the fit's modes. Empty:
  /// both are at one place. Else each keeps its own row.
  Eigen::VectorXd at_output, at_input;
  /// −1: the channels state opposite directions, so that a shape has opposite values at them. The
  /// simulated shapes are along the stated directions and need no sign.
  int sign = 1;

  [[nodiscard]] bool is_one_place() const { return at_output.size() == 0 && at_input.size() == 0; }
};

/// Pairs each output with the nearest input within `within_m` that acts along the same line, in its
/// direction or against it. Distances are seen along that line: a sensor and an actuator on the two
/// faces of a plate are in one place. The nearest pair comes first, of equally near ones that which
/// is also nearer along the line, and no channel occurs twice. Channels without a position are left
/// out. A direction that is not stated is any.
[[nodiscard]] std::vector<CollocatedPair> collocated_pairs(
    const std::vector<modal::MeasuredChannel>& outputs,
    const std::vector<modal::MeasuredChannel>& inputs, double within_m);

enum class GainRule {
  /// α⁴ = Σ L² / Σ R² over the pairs (5.5); rows of L do not change. The thesis' rule.
  thesis,
  /// The most likely L, R and α that agree at the pairs, with the covariance of the fit: all rows
  /// of the mode change. To first order this equals a fit with the constraint L_c = R_c.
  tied,
};

/// The side of a pair that its gain ratio corrects.
enum class GainFault { nobody, outputs, inputs };

/// Positions of the channels, for rigid-body motion.
struct RigidGeometry {
  Eigen::MatrixXd outputs, inputs;      ///< p×r, q×r, as rigid_directions gives them
  std::vector<Eigen::Index> suspended;  ///< modes above 0 Hz that move (nearly) as a rigid body
  double bending = 0.0;      ///< deviation of those modes from rigid motion, a part of the rms
  bool pairs_first = false;  ///< the geometry scales only the modes that no pair scales
};

/// Data of a simulation, for modes that no pair scales (priors/gain.h).
struct GainPrior {
  priors::Places outputs, inputs;
  priors::ModalBasis basis;
  priors::DynamicResidual residual;
  /// Other plausible simulations (without any of their own), one deviation of what was learned away
  /// along each of its directions: the squared changes of ln β add up to a variance.
  std::vector<GainPrior> aside = {};
  std::vector<std::string> doubts = {};  ///< of the simulation; a warning where it scales a mode
};

struct GainMatchOptions {
  std::vector<CollocatedPair> pairs;
  GainRule rule = GainRule::tied;
  GainFault fault = GainFault::nobody;
  double significance = 3.0;      ///< a pair counts for a mode where |L_c R_c| is above this many
  double simulation_error = 0.1;  ///< at each place of a near pair, relative to the change
  std::optional<RigidGeometry> geometry;
  std::optional<GainPrior> prior;
};

/// The information that gave the scale of a mode.
enum class MatchedBy { pairs, geometry, prior, nothing };

/// φ = L/α at the sensors and ± α R at the actuators. For blocks and 0 Hz modes α is 1: there the
/// two sides differ by more than one scale.
struct ModeMatch {
  MatchedBy by = MatchedBy::nothing;
  double alpha = 1.0, alpha_std = 0.0;
  int sign = 1;               ///< −1: sensors and actuators have opposite directions
  double disagreement = 0.0;  ///< χ² of the pairs (or places) beyond what α needs
  Eigen::Index freedoms = 0;  ///< its degrees of freedom
};

/// True if the pairs (or places) of the mode contradict each other beyond what the fit's noise
/// allows.
[[nodiscard]] bool contradicted(const ModeMatch& mode);

/// Gain of the sensor over the gain of the actuator, up to one factor for all pairs
/// (their mean ln is 0). Where no mode compares some pairs with the others, such as pairs of parts
/// of the channels that no response connects, the mean ln is 0 in each part by itself.
struct PairGain {
  /// The deviation is infinite where the ratio to all told pairs is not known: no mode tells it
  /// beside other pairs, or the told pairs are in several parts.
  double ratio = 1.0, ratio_std = 0.0;
  bool turned = false;     ///< one of the two has the opposite direction to the other pairs
  Eigen::Index modes = 0;  ///< modes that give the ratio; without any, or of one pair, it is 1
  Eigen::Index part = 0;   ///< modes compare it with pairs of the same number, if any tells it
  double part_std = 0.0;   ///< deviation of the ratio to the pairs of its part, where it has modes
};

/// A row of the extended output matrix.
struct MatchedRow {
  bool actuator = false;
  Eigen::Index channel = 0;
};

/// Mass-normalised shapes at all places, n_z = n_s + n_a − n_c of them (5.2): first all sensors,
/// then the actuators without a sensor at their place. Modes in the order of the fit.
struct GainMatch {
  std::vector<ModeMatch> modes;     ///< m
  std::vector<PairGain> pairs;      ///< as in the options
  std::vector<MatchedRow> rows;     ///< n_z
  Eigen::MatrixXd shapes;           ///< n_z×m [kg^-1/2]
  Eigen::MatrixXd deviation;        ///< n_z×m; infinite for a mode without a match: its shape then
                                    ///< has the same rms on both sides, which is a guess
  Eigen::MatrixXd input_shapes;     ///< m×q [kg^-1/2], all actuators, in the scale of `shapes`
  Eigen::MatrixXd input_deviation;  ///< m×q
  /// Covariances of (ω_m, ζ_m, φ at the p sensors, input_shapes), (2+p+q) squared, in [rad/s], [1]
  /// and kg^-1/2, that the errors of the fit leave; what a simulation or a bending leaves open of
  /// the scale is in the deviations alone. Empty for blocks, modes at 0 Hz and modes without a
  /// scale.
  std::vector<Eigen::MatrixXd> mode_covariance;
  Eigen::MatrixXd residual;  ///< p×q: of the fit, in the signs and gains of the shapes; or empty
  /// p×q: false where the response was not measured; the residual there has no meaning. Where none
  /// was fitted it is known to be 0. Empty: all are known.
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> residual_known;
  /// Imaginary parts of complex shapes at the rows and at the actuators, n_z×m and m×q; empty for
  /// real shapes. The phase between both sides is the one at which the pairs agree.
  Eigen::MatrixXd imaginary, imaginary_deviation, input_imaginary;
  std::optional<RigidBody> rigid;  ///< from the modes at 0 Hz, where the geometry is given
  /// −1: as a whole the actuators count against the sensors. Shapes and residual are along the
  /// stated directions; the responses that were measured are then those of their opposite.
  int side = 1;
  std::vector<std::string> warnings;
};

/// The input shapes with the signs of the data, m×q: the shapes at the sensors times these are the
/// measured residues, also where actuators count against their directions.
[[nodiscard]] Eigen::MatrixXd driving_shapes(const GainMatch& match);
/// Their imaginary parts; empty for real shapes.
[[nodiscard]] Eigen::MatrixXd driving_imaginary(const GainMatch& match);

/// @param outputs, inputs  the channels, for their names
/// Cost: (p + q)² per mode and block.
/// @throws InvalidInput  sizes differ, a pair names a channel that is not there or one twice
[[nodiscard]] GainMatch gain_match(const ModalFit& fit,
                                   const std::vector<modal::MeasuredChannel>& outputs,
                                   const std::vector<modal::MeasuredChannel>& inputs,
                                   const GainMatchOptions& options);

/// The modal model from the actuators, along their directions, to all n_z places. Its residual is
/// known only at the sensors.
[[nodiscard]] modal::ReducedModel extended_model(const ModalFit& fit, const GainMatch& match);

/// The same from the actuators as they act: it has the signs of the measured responses.
[[nodiscard]] modal::ReducedModel driven_model(const ModalFit& fit, const GainMatch& match);

}  // namespace chladni::identification
