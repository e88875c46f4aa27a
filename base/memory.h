// The memory that the machine has available.
#pragma once

#include <cstddef>

namespace chladni {

/// Bytes that can be allocated without swapping. This is the smallest of the kernel's MemAvailable
/// and the rest of the limits of the control groups and of `ulimit -v`. Where none of these can be
/// read, it is all the physical memory.
[[nodiscard]] std::size_t available_memory();

}  // namespace chladni
