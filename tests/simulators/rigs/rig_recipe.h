// How a real rig differs from the believed one, and its modes with all of it.
#pragma once

#include <string>
#include <vector>

#include "simulators/plates/ritz_response.h"
#include "simulators/portable_random.h"
#include "simulators/rigs/real_rig.h"

namespace chladni::simulators {

/// A mode of the frame that carries the sensors and takes the reactions. It does not touch the
/// body.
struct FrameMode {
  double mass = 0.0, frequency_hz = 0.0, damping_ratio = 0.0;
  Eigen::VectorXd outputs, inputs;  ///< motion at the channels
};

/// Draws of the model-form error: one column for each mode.
struct ModelFormError {
  double frequency = 0.0, shape = 0.0, phase = 0.0;  ///< levels
  bool of_body = false;                              ///< RealRigOptions::errors_of_body
  Eigen::VectorXd frequency_draw;                    ///< n
  Eigen::MatrixXd shape_draw, phase_draw;            ///< (p+q)×n
};

struct RigRecipe {
  RealBody body;  ///< as believed
  RitzBody plate;
  TableChannels channels;                   ///< with the places as they are
  std::vector<Eigen::Index> output_of;      ///< the sensor that a record shows
  Eigen::VectorXd output_gain, input_gain;  ///< of the sensors and actuators
  std::vector<RitzPoint> points;
  std::vector<RitzResonator> resonators;
  std::vector<RitzPad> pads;
  std::vector<FrameMode> frames;
  Eigen::VectorXd damping_factor;  ///< of the bare modes; the others have 1
  ModelFormError error;
};

[[nodiscard]] RigRecipe believed_recipe(const RealBody& body);

/// Adds what a real rig has.
void add_nature(RigRecipe& recipe, unsigned seed, const RealRigOptions& options);

/// n numbers of Student's t with a third of the variance in common, times `size`.
[[nodiscard]] Eigen::VectorXd alike(Dice& dice, Eigen::Index n, double size);
/// k×n normal numbers of deviation 1; the rows are correlated between neighbouring places.
[[nodiscard]] Eigen::MatrixXd smooth_draws(Dice& dice, const Eigen::MatrixX2d& places,
                                           double length, Eigen::Index n);

/// Draws of an effect.
struct RigDraw {
  Dice dice;
  double severity = 0.0;
  double mass = 0.0;  ///< RealRigOptions::mass
  std::vector<Eigen::Vector2d> taken_places = {};
  std::vector<Eigen::Index> taken_sensors = {};

  /// low (high / low)^severity, a little off.
  double size(double low, double high) const;
  double sign() { return dice.uniform() < 0.5 ? -1.0 : 1.0; }
  /// A place on the body; on the middle line of a slender one.
  Eigen::Vector2d place(const RealBody& body, double margin);
  /// A unit vector, along a slender body.
  Eigen::Vector2d direction(const RealBody& body);
  Eigen::Index sensor(const RigRecipe& recipe);
};

struct RealKind {
  std::string name;
  bool outside = false;
  HiddenEffect (*hide)(RigRecipe&, RigDraw&);
};
[[nodiscard]] const std::vector<RealKind>& all_real_kinds();

/// The damped modes at the records, in the whole stage, without noise. G = Σ residue / (ω² − Ω² +
/// 2i ζ ω Ω) near each resonance; residue(i, j) = outputs(i) inputs(j).
struct RigModes {
  Eigen::MatrixXd rigid_outputs, rigid_inputs;  ///< p×r, q×r of modes at 0 Hz
  Eigen::VectorXcd pole;                        ///< m [rad/s], Im > 0, ascending
  Eigen::MatrixXcd outputs, inputs;             ///< p×m, q×m [kg^-1/2]
  Eigen::MatrixXd above;                        ///< p×q [m/N]: static part of the modes above

  [[nodiscard]] Eigen::VectorXd frequency_hz() const;  ///< |pole| / 2π
};
[[nodiscard]] RigModes rig_modes(const RigRecipe& recipe, const BareModes& bare);

/// [k], p×q: the receptances on these lines.
[[nodiscard]] std::vector<Eigen::MatrixXcd> receptances(const RigModes& modes,
                                                        const Eigen::VectorXd& hz);

/// The columns of modes within the band that the channels see (three hundredths of the median
/// size).
[[nodiscard]] std::vector<Eigen::Index> seen_modes(const RigModes& modes, double low_hz,
                                                   double high_hz);

}  // namespace chladni::simulators
