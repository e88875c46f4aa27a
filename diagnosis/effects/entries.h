// The effects of the catalogue, each a record in its file (entries.inc).
#pragma once

#include "diagnosis/effect.h"

namespace chladni::diagnosis {

#define EFFECT(name, file) extern const Effect name;
#include "diagnosis/effects/entries.inc"
#undef EFFECT

/// The parameters of an effect that is only a choice.
[[nodiscard]] inline std::vector<Parameter> no_sizes(const Structure& /*structure*/) { return {}; }

}  // namespace chladni::diagnosis
