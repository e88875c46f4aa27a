// A body that is not the same in all experiments: each column of the record from its own.
#pragma once

#include "diagnosis/fit/responses.h"

namespace chladni::diagnosis {

/// Whether some column was measured of a stiffer or softer body.
[[nodiscard]] bool drifts(const State& state);

/// What was measured as column j of the record: one input, the body as stiff as it then was.
[[nodiscard]] State experiment(const State& state, Eigen::Index j);
[[nodiscard]] Solved experiment(const Solved& solved, const State& state, Eigen::Index j);

}  // namespace chladni::diagnosis
