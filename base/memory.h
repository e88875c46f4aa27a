// What the machine has to give.
#pragma once

#include <cstddef>

namespace chladni {

/// Bytes that can be allocated without swapping: MemAvailable of the kernel, or what is left of the
/// limits of the control groups or of `ulimit -v` where that is less; all there is where none can
/// be read.
[[nodiscard]] std::size_t available_memory();

}  // namespace chladni
