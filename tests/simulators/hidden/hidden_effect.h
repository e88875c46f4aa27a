// Measurements of a rig in which something is hidden. A seed determines the effect, its place and
// its size. A diagnosis gets `measured` and nothing else.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "modal/frf_set.h"
#include "simulators/plates/ritz_plate.h"

namespace chladni::simulators {

/// One effect of the truth. The names of `size` are those of the kind's table
/// (hidden_..._kinds.cpp), in SI.
struct HiddenEffect {
  std::string kind;
  std::map<std::string, double> size;
  std::optional<Eigen::Vector2d> place;  ///< [m]
  std::vector<std::string> channels;
};

/// The law of the deviations between rigs. Each law has variance 1, except Student's.
enum class DeviationLaw {
  normal,
  uniform,
  student,  ///< t of four degrees of freedom: variance 2, one in 90 beyond 3.7
};

struct HiddenOptions {
  std::string rig = "table";  ///< rig_names()
  int lines = 500;
  double low_hz = 0.0, high_hz = 0.0;  ///< 0: the rig's
  double relative_noise = 0.01;  ///< circular, E|n|² = σ², of |G| of the same line and response
  double floor_noise = 1e-3;     ///< fraction of the median |G| over all; squares add
  int degree = 14;               ///< of the plates' polynomials
  /// 0 (hardly visible) to 1 (large), on a logarithmic scale between the ends of each kind's range;
  /// below 0: drawn.
  double severity = -1.0;
  /// True: the damping is a matrix that does not change when the plate changes. False: the modes of
  /// the changed plate have the damping of the nominal modes.
  bool damping_stays = true;
  /// Deviations of every rig, in multiples of: gain of each channel 0.5 %, its place 0.5 mm along
  /// each axis, delay 1 µs, modulus 0.5 %, density 0.3 %, thickness 0.15 % in each of six smooth
  /// waves, stiffness along x 0.5 %, damping of each mode 20 %.
  double deviation = 0.0;
  /// With another law than the normal one, the thickness varies in 21 waves up to the fifth order,
  /// each 0.3 % over 2 + i + j. No diagnosis has these waves.
  DeviationLaw law = DeviationLaw::normal;
  /// The fraction of the variance that all gains, all places of a side along an axis, and all
  /// dampings share.
  double correlation = 0.0;
  double own_delay_s = 0.0;  ///< of each channel, beside the common delay
  double fixtures = 0.0;     ///< of masses and springs fixed to the body, relative
  /// True: hidden masses sit on the upper face, as on a solid, and move aside with it. False: they
  /// sit on the middle plane, as a diagnosis from a plate's deflections has them.
  bool on_face = false;
  /// The modes that `modes_above` softens begin here; 0: after 64.
  double above_hz = 0.0;
};

struct HiddenCase {
  modal::FrfSet measured;  ///< receptances by name, with places, directions and true variances
  std::vector<HiddenEffect> truth;
  bool outside = false;  ///< the truth has a kind that is in no catalogue of physical causes
  std::vector<Eigen::MatrixXcd> exact;  ///< [k], p×q: without noise
  /// As `exact`, with tilted channels moved so far that the effect is nearly the same (where gains
  /// deviate, with the gain that a tilt costs); empty: no channel is tilted.
  std::vector<Eigen::MatrixXcd> moved_instead;
  /// Σ |exact − nominal|² / σ²: the logarithm of the likelihood ratio for an effect that is known
  /// in advance.
  double evidence_there = 0.0;
};

/// Kinds that a diagnosis should name, and kinds that it cannot name. "none" is in neither list.
[[nodiscard]] const std::vector<std::string>& hidden_kinds();
[[nodiscard]] const std::vector<std::string>& outside_kinds();

/// Two kinds of hidden_kinds() that can be distinguished when they act together.
[[nodiscard]] std::vector<std::string> hidden_pair(unsigned seed);

/// The modes of the rig as believed before the measurement. They are kept between calls.
[[nodiscard]] const RitzModes& believed_modes(const std::string& rig, int degree = 14);
/// The believed modes of the wafer table: aluminium_table.
[[nodiscard]] const RitzModes& believed_table(int degree = 14);

/// Makes a case. Cost: 0.3 to 1.5 s for 500 lines and degree 14.
/// @param kinds  none, one or several; several kinds act on different channels and places
/// @throws InvalidInput  an unknown kind or rig, a kind that the rig cannot have
[[nodiscard]] HiddenCase hidden_case(const std::vector<std::string>& kinds, unsigned seed,
                                     const HiddenOptions& options = {});

}  // namespace chladni::simulators
