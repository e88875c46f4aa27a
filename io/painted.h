// The painter's answer to a request.
#pragma once

#include <string>

#include "io/message.h"

namespace chladni::io {

/// The PNG that the program chladni-painter makes of `request` (io/picture/pictures.h).
/// @throws WorkerDied  the painter or xvfb is missing or died (says which package)
[[nodiscard]] std::string painted(const Message& request);

}  // namespace chladni::io
