// The memory that the machine has available.
#pragma once

#include <cstddef>

namespace chladni {

/// Bytes that can be allocated without swapping. This is the smallest of the kernel's MemAvailable
/// and the rest of the limits of the control groups and of `ulimit -v`. Where none of these can be
/// read, it is all the physical memory.
[[nodiscard]] std::size_t available_memory();

/// A limit that a user states, 0 for none. One beyond all addresses is the largest that there is.
/// @throws InvalidInput  less than 0, or not a number
[[nodiscard]] std::size_t bytes_of_gigabytes(double gigabytes);

/// Gives memory that was freed back to the system, where the C library (glibc) holds it for later.
/// Costs some milliseconds; for use before an allocation that is as large as all before.
void release_freed_memory();

}  // namespace chladni
