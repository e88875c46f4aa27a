// Measured responses of structures that are known exactly. The truth uses no code of
// identification/.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "modal/frf_set.h"
#include "modal/reduced_model.h"

namespace chladni::simulators {

/// The faults between the structure and its record. Noise is circular, E|n|² = σ², independent
/// between lines and responses.
struct FrfFaults {
  double relative_noise = 0.01;    ///< σ as a fraction of |G₀| of the same line and response
  double floor_noise = 0.0;        ///< σ as a fraction of the median |G₀| over all; squares add
  bool noisy = true;               ///< false: σ is stated, no noise is added
  double delay_s = 0.0;            ///< of all responses
  Eigen::VectorXd output_delay_s;  ///< p, added to delay_s; empty: none
  Eigen::VectorXd output_gain;     ///< p; −1: reversed, 0: dead (its noise stays); empty: 1
  Eigen::VectorXd input_gain;      ///< q, as output_gain
  double out_of_band = 0.0;  ///< above 0: one more mode, higher than the last line by this
                             ///< fraction, 0.5 % damped
  double dashpot = 0.0;      ///< [N s/m] at the first sensor; it makes the modes complex
  double missing = 0.0;      ///< fraction of the values, drawn at random, that are NaN
  unsigned seed = 1;
};

/// A record and its truth.
struct FrfCase {
  modal::FrfSet measured;               ///< y1.. by u1.., receptances with their true variance
  std::vector<Eigen::MatrixXcd> exact;  ///< [k], p×q: without noise, with all other faults
  modal::ReducedModel
      truth;  ///< the structure: gains are not in it, a mode out of band is the last
  FrfFaults faults;
  std::vector<std::pair<Eigen::Index, Eigen::Index>> collocated;  ///< output, input
};

/// Channels and lines of a record.
struct FrfGrid {
  Eigen::MatrixX3d outputs, inputs;  ///< places [m]; equal places are collocated
  Eigen::VectorXd frequency_hz;
};

/// A record of any structure. Its dampers may be set; `faults.dashpot` adds one.
[[nodiscard]] FrfCase frf_case(const modal::ReducedModel& truth, const FrfGrid& grid,
                               const FrfFaults& faults);

/// The thesis' beam, 0.157 kg and 500 mm: translation and rotation on the suspension at 2.5 and
/// 5 Hz (2 % damping), and the first three shapes of a free Euler-Bernoulli beam at 32.7, 51.9 and
/// 110 Hz (0.8, 0.5, 1 %). Sensors are at −200, −100, 0, 100, 200 mm; actuators are at all of these
/// places or at places 1, 3 and 5. Place 3 is a node of modes 2 and 4. 799 lines of 0.25 Hz up to
/// 200 Hz.
[[nodiscard]] FrfCase beam5x3(const FrfFaults& faults = {});
[[nodiscard]] FrfCase beam5x5(const FrfFaults& faults = {});

/// The wafer table at the channels of models/oat/minimal: a free plate, first flexible mode at
/// 139 Hz, 0.2 % narrower than long so that pairs are split; three rigid-body modes at 0 Hz, the
/// first 17 flexible ones that both sides see, 0.3 to 1 % damped. 3981 lines, 10 to 2398 Hz.
[[nodiscard]] FrfCase oat4x13(const FrfFaults& faults = {});

/// Modes at 50, 100, 100 (1 + split) and 180 Hz, 4 outputs, 3 inputs, three of them collocated; the
/// pair is damped by `first` and `second`, the others by 1 %. 921 lines, 20 to 250 Hz.
[[nodiscard]] FrfCase pairs(double split, double first, double second,
                            const FrfFaults& faults = {});

/// A free plate seen at `outputs` and `inputs` random places, none collocated: three rigid-body
/// modes at 0 Hz, `modes` − 3 flexible ones. `lines` up to 1.2 times the last mode.
[[nodiscard]] FrfCase big(Eigen::Index outputs, Eigen::Index inputs, Eigen::Index modes,
                          Eigen::Index lines, const FrfFaults& faults = {});

/// The chosen rows and columns of a case, in this order.
[[nodiscard]] FrfCase part(const FrfCase& whole, const std::vector<Eigen::Index>& outputs,
                           const std::vector<Eigen::Index>& inputs);

/// Poles (Im > 0) of the flexible modes with the dampers, ascending, and
/// G = Σ l r / (s − p) + conjugates, without the part of modes at 0 Hz. Gains are not included.
struct ComplexModes {
  Eigen::VectorXcd pole;             ///< n [rad/s]
  Eigen::MatrixXcd outputs, inputs;  ///< p×n, n×q
};
/// @pre no damper reaches a rigid-body mode
[[nodiscard]] ComplexModes complex_modes(const modal::ReducedModel& truth);

}  // namespace chladni::simulators
