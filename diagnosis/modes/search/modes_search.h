// Search for the causes that explain modal data.
#pragma once

#include <vector>

#include "base/progress.h"
#include "diagnosis/modes/modes_fit.h"

namespace chladni::diagnosis {

struct ModesFound {
  ModesFit nothing;                 ///< the structure as it is
  std::vector<ModesFit> fits;       ///< causes, in full; descending evidence
  std::vector<ModesFit> disturbed;  ///< no cause, but a mode or a channel is not believed
  double effects = 0.0;             ///< number of effects that change these data
  /// Power of the evidence in the weight of a hypothesis: 1 where the study states the errors.
  double evidence_power = 1.0;
};

/// How near the sizes of the starts of an effect are to each other.
enum class StartSizes {
  usual,
  near,  ///< so near that a mode that a spring makes is paired with a measured one
};

/// True if an effect has a place and a frequency: at each frequency it splits another mode in two.
[[nodiscard]] bool is_tuned(const Structure& structure, const Effect& effect);

/// Starts of an effect for every choice, on a grid that follows from the roles of its parameters:
/// places spread over the surface, sizes of both signs, frequencies over the measured band. What
/// has a place and a frequency stands at each measured frequency too, and is light there.
/// @param measured_hz  at least one
[[nodiscard]] std::vector<Supposed> grid_of(const Structure& structure, const Effect& effect,
                                            const Eigen::VectorXd& measured_hz,
                                            StartSizes sizes = StartSizes::usual);

/// Every effect at every point of its grid, with the levels that the structure as it is leaves; the
/// likeliest are fitted in full. Then a second and a third cause beside the best ones, as long as
/// the evidence rises by `least_evidence`, and of the best of these the earlier causes again beside
/// the last one. Cost: on two cores, for 12 modes and 17 channels, 2 s without a cause, 5 to 20 s
/// with one or two.
[[nodiscard]] ModesFound searched(const ModesProblem& problem,
                                  const std::vector<const Effect*>& catalogue, int most_causes,
                                  double least_evidence, const Progress& progress = {});

}  // namespace chladni::diagnosis
