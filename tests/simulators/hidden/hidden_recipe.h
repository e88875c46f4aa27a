// How a rig differs from the believed rig. The kinds of effects fill it in, one after the other.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "simulators/hidden/hidden_effect.h"
#include "simulators/plates/ritz_response.h"
#include "simulators/portable_random.h"
#include "simulators/tables/rig.h"

namespace chladni::simulators {

/// The filter between a channel and its record. Values of 0 mean no filter.
struct ChannelFilter {
  double gain = 1.0, delay_s = 0.0;
  double corner_hz = 0.0;                      ///< first-order low-pass
  double notch_hz = 0.0, notch_damping = 0.0;  ///< (s² + ω²) / (s² + 2 ζ ω s + ω²)
  int power = 0;                               ///< times (jω)^power
};

struct Recipe {
  Rig rig;          ///< as it is believed to be
  int degree = 14;  ///< of rig_named
  RitzBody body;
  bool same_body = true;
  std::vector<RitzPoint> points;
  bool on_face = false;  ///< as HiddenOptions
  std::vector<RitzResonator> resonators;
  std::vector<RitzPad> pads;
  std::optional<RitzFrame> frame;
  double damping_factor = 1.0, damping_exponent = 0.0;
  bool hysteretic = false;
  double yielding = 0.0;  ///< relative softening of the modes above those of a diagnosis
  double above_hz = 0.0;  ///< where these modes begin; 0: after 64
  double held_hz = 0.0, held_damping = 0.0;  ///< of all rigid-body modes
  Eigen::VectorXd stiffening;      ///< q: of the plate while an input is used, relative; or empty
  Eigen::VectorXd damping_spread;  ///< factors of the first modes; the others do not change
  TableChannels channels;
  Eigen::MatrixX2d output_tilts, input_tilts;     ///< of the channels, toward x and y [rad]
  std::vector<Eigen::Index> output_of, input_of;  ///< the channel that a record shows
  std::vector<ChannelFilter> outputs, inputs;     ///< of the records
  Eigen::MatrixXd output_mix, input_mix;          ///< (1 + Y) G (1 + X)
  /// A mode that is not of the plate's bending.
  double foreign_hz = 0.0, foreign_damping = 0.0;
  Eigen::VectorXd foreign_outputs, foreign_inputs;  ///< [kg^-1/2]
};

/// [k], p×q: the recorded responses.
/// @param damping_stays  as HiddenOptions
[[nodiscard]] std::vector<Eigen::MatrixXcd> responses(const Recipe& recipe,
                                                      const Eigen::VectorXd& hz,
                                                      bool damping_stays);

/// Adds the deviations of HiddenOptions, within usual tolerances.
void deviate(Recipe& recipe, Dice& dice, const HiddenOptions& options);

/// The draws of a kind: sizes within its range, and places.
struct Drawn {
  Dice dice;
  double severity;  ///< in [0, 1]
  RigScale scale;
  Eigen::Vector2d half;  ///< sides of the body [m]
  bool slender = false;
  std::vector<Eigen::Vector2d> taken_places;
  std::vector<std::string> taken_channels;

  /// low (high / low)^severity.
  double size(double low, double high);
  double sign() { return dice.uniform() < 0.5 ? -1.0 : 1.0; }
  /// A place at least `margin` from the rim and 120 mm from others (on the table). On a slender
  /// body it lies on the middle line.
  Eigen::Vector2d place(double margin = 0.01);
  /// A unit vector; along the body where it is slender.
  Eigen::Vector2d direction();
  /// A channel without another effect.
  Eigen::Index channel(const std::vector<std::string>& names);
};

struct HiddenKind {
  std::string name;
  bool outside = false;
  HiddenEffect (*hide)(Recipe&, Drawn&);
};
/// Kinds of the body and its fixtures; kinds of the channels; kinds that no catalogue has.
[[nodiscard]] const std::vector<HiddenKind>& body_kinds();
[[nodiscard]] const std::vector<HiddenKind>& channel_kinds();
[[nodiscard]] const std::vector<HiddenKind>& kinds_outside();

}  // namespace chladni::simulators
