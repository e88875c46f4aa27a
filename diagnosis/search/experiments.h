// A body that differs between experiments: each column of the record has its own body.
#pragma once

#include "diagnosis/fit/responses.h"

namespace chladni::diagnosis {

/// True if some column was measured on a stiffer or softer body.
[[nodiscard]] bool drifts(const State& state);

/// The state of experiment j, which measured column j of the record: one input, and the body with
/// its stiffness at that time.
[[nodiscard]] State experiment(const State& state, Eigen::Index j);
[[nodiscard]] Solved experiment(const Solved& solved, const State& state, Eigen::Index j);

}  // namespace chladni::diagnosis
