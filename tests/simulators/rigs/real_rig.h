// Measurements of real rigs, as responses and as modes, with something hidden. A diagnosis gets
// `measured` or `modes`, and nothing else. No deviation of the rig is announced to it.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/measured_modes.h"
#include "modal/frf_set.h"
#include "simulators/hidden/hidden_effect.h"
#include "simulators/rigs/real_body.h"

namespace chladni::simulators {

struct RealRigOptions {
  /// Multiplies what real rigs have and no model has: modulus and density 1 to 2 %, thickness a
  /// smooth field of 0.5 to 1 %, damping of each mode (log-normal, 0.3), gains 2 % and places 1 mm
  /// (Student's t of four degrees of freedom, a third of the variance shared), accelerometers,
  /// cables, strings, a frame, and the model-form errors below. 0: the rig is as believed.
  double nature = 1.0;
  /// Direct model-form errors, standard deviations: of ln f of each mode, and of its shape at each
  /// channel in units of its rms there, correlated between neighbouring channels. Below 0: drawn, 1
  /// to 3 % and 5 to 10 %.
  double frequency_error = -1.0, shape_error = -1.0;
  /// Whose modes have these errors. False: those of the rig with all that is on it. True: those of
  /// its bare body, so that an effect acts on them as on the modes of any structure. Before and
  /// after an effect only these are the same errors, where modes turn into each other.
  bool errors_of_body = false;
  double severity = -1.0;  ///< 0 to 1: between the ends of each kind's range; below 0: drawn
  int repetition = 0;      ///< another one is measured anew: other noise, other complex factors
  double mass = 0.0;       ///< of a point mass, over that of the body; 0: by `severity`

  int lines = 400;
  double relative_noise = 0.01;  ///< of the responses, of |G| of the same line
  double floor_noise = 1e-3;     ///< fraction of the median |G|; squares add
  double shared_noise = 0.3;     ///< fraction of the variance that all sensors share

  double frequency_noise = 2e-4;  ///< of the modes, relative
  double damping_noise = 0.05;    ///< of ln ζ
  double shape_noise = -1.0;      ///< complex, in units of the mode's rms; below 0: 0.5 to 1 %
  /// True: the products of the shapes are residues. False: each mode has an unknown complex factor.
  bool scaled = true;
};

struct RealRigCase {
  RealBody body;  ///< as believed
  modal::FrfSet measured;
  std::vector<Eigen::MatrixXcd> exact;  ///< [k], p×q: `measured` without noise
  diagnosis::MeasuredModes modes;
  std::vector<HiddenEffect> truth;  ///< sizes with the rig's own deviation of the same constant
  /// What the rig has beside the truth and a catalogue names, too: the string's resonance, a gain
  /// that Student's law drew more than 8 % off the others, a channel that it moved by more than
  /// 4 mm. To name it is not false, nor is it asked for.
  std::vector<HiddenEffect> present;
  bool outside = false;  ///< the truth has a kind that no catalogue has
  bool scaled = true;
  double frequency_error = 0.0, shape_error = 0.0;  ///< levels that were drawn
  /// log10 of the ln evidence that an ideal judge of modes has who knows the levels: half the sum
  /// of squares of the changes of ln f and shapes over their levels. 1: clear; 0: at the limit.
  double clear = 0.0;
};

/// Kinds that a catalogue has, and kinds outside. "none" is in neither list.
[[nodiscard]] const std::vector<std::string>& real_kinds();
[[nodiscard]] const std::vector<std::string>& real_outside_kinds();

/// Two of real_kinds(), joined with '+', at least one of which is not of a channel.
[[nodiscard]] std::string real_pair(unsigned seed);

/// Makes a case. The rig depends on body and seed only, the effect on the kind as well. Cost: two
/// calls of bare_modes.
/// @param kind  "none", a kind, or two kinds joined with '+'
/// @throws InvalidInput  an unknown body or kind
[[nodiscard]] RealRigCase real_rig_case(const std::string& body, const std::string& kind,
                                        unsigned seed, const RealRigOptions& options = {});

}  // namespace chladni::simulators
