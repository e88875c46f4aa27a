// The body as a whole and its decoupling matrices, as text, JSON and MATLAB's fields.
#pragma once

#include <string>

#include "io/json.h"
#include "io/mat.h"
#include "steps/rigid_body.h"

namespace chladni::show {

/// Mass, centre and inertia with deviations, then a sentence for each side on its decoupling.
[[nodiscard]] std::string rigid_body_text(const steps::RigidBodyOfChannels& found);
[[nodiscard]] io::Json rigid_body_json(const steps::RigidBodyOfChannels& found);
/// A structure with the same content.
[[nodiscard]] io::MatValue rigid_body_mat(const steps::RigidBodyOfChannels& found);

}  // namespace chladni::show
