// The tolerances of a structure as parameters, each of unit normal prior.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "diagnosis/fit/state.h"
#include "diagnosis/tolerances.h"

namespace chladni::diagnosis {

/// One thing that may be off: `apply(state, eta)` takes it eta deviations away. What it changes
/// together with causes alone (State::loaded_damping) is done where the causes are known.
struct Deviation {
  std::string name;  ///< "gain of sensor s1", "frequency of the mode at 183.8 Hz"
  std::function<void(State&, double eta)> apply;
};

/// In the order in which they act; before any effect. Modes up to `high_hz` have their
/// own frequency and damping; neighbours nearer than two half-power bandwidths have a
/// symmetric block of both. A frequency may be off by the tolerance and by what its own mesh leaves
/// (Structure::frequency_error), squares added.
/// The structure must outlive them. Deviations of zero are left out.
[[nodiscard]] std::vector<Deviation> deviations(const Structure& structure,
                                                const Tolerances& tolerances, double high_hz);

/// Errors of the mode shapes up to `high_hz` at each channel, of `response` times the mode's root
/// mean square over the channels of that side: what correlates the errors of a response along its
/// lines. Some (p + q) times the number of modes: for the last word, not for a search.
[[nodiscard]] std::vector<Deviation> shape_deviations(const Structure& structure, double response,
                                                      double high_hz);

}  // namespace chladni::diagnosis
