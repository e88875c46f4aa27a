// The painter's answer to a request.
#pragma once

#include <string>

#include "io/bytes/message.h"

namespace chladni::io {

/// The PNG that the program chladni-painter makes from `request` (io/picture/pictures.h).
/// @throws WorkerDied  the painter or Xvfb is missing or died (says which package), or gave no PNG
[[nodiscard]] std::string painted(const Message& request);

}  // namespace chladni::io
