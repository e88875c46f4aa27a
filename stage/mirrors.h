// The mirror planes that a study states.
#pragma once

#include <string>
#include <vector>

#include "fem/mirrors.h"
#include "stage/model.h"

namespace chladni::stage {

/// Those across `axes` ("x", "y", "z"), of the model with all that is attached to it.
/// @throws InvalidInput  the body is not its own mirror image (as fem::mirror_of)
[[nodiscard]] std::vector<fem::Mirror> mirrors_of(const Model& model, const fem::System& system,
                                                  const std::vector<std::string>& axes);

}  // namespace chladni::stage
