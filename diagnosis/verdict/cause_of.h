// A supposed cause in the words of an answer.
#pragma once

#include "diagnosis/diagnosed.h"
#include "diagnosis/effect.h"

namespace chladni::diagnosis {

/// Name, channels, place and numbers of a cause.
/// @param variance  of its coordinates x
[[nodiscard]] Cause cause_of(const Structure& structure, const Supposed& supposed,
                             const Eigen::VectorXd& variance);

}  // namespace chladni::diagnosis
