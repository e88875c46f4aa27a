// The tolerances of a structure as nuisance parameters, each with a unit normal prior.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "diagnosis/fit/state.h"
#include "diagnosis/tolerances.h"

namespace chladni::diagnosis {

/// One nuisance parameter: `apply(state, eta)` moves it by eta standard deviations. A change that
/// also depends on the causes (State::loaded_damping) is made where the causes are known.
struct Deviation {
  std::string name;  ///< "gain of sensor s1", "frequency of the mode at 183.8 Hz"
  std::function<void(State&, double eta)> apply;
  bool is_constant = false;  ///< a calibrated constant: it also acts at eta = 0, its start
};

/// All deviations, in the order in which they act, before any effect. Each mode up to `high_hz` has
/// its own frequency and damping. Neighbours nearer than two half-power bandwidths share a
/// symmetric 2×2 block. The deviation of a frequency combines the tolerance and the error of the
/// mode's own mesh (Structure::frequency_error), squares added. The structure must outlive them.
/// Deviations of zero are left out.
[[nodiscard]] std::vector<Deviation> deviations(const Structure& structure,
                                                const Tolerances& tolerances, double high_hz);

/// The structure with its deviations at these values. No values: the structure as it is.
[[nodiscard]] State deviating(const Structure& structure, const std::vector<Deviation>& deviations,
                              const Eigen::VectorXd& eta);

/// Errors of the mode shapes up to `high_hz` at each channel: `response` times the root mean square
/// of the mode over the channels of that side. They correlate the errors of a response along its
/// lines. There are (p + q) times the number of modes: for the final fit, not for a search.
[[nodiscard]] std::vector<Deviation> shape_deviations(const Structure& structure, double response,
                                                      double high_hz);

}  // namespace chladni::diagnosis
