// The filter of system calls of a confined worker, as a program of the kernel's packet filter.
#pragma once

#include <linux/filter.h>

#include <cstdint>
#include <vector>

namespace chladni {

#if defined(__x86_64__) || defined(__aarch64__)
inline constexpr bool kHasCallFilter = true;
#else
inline constexpr bool kHasCallFilter = false;  ///< its numbers are of other processors
#endif

/// The filter; a process number stands in it that set_own_process replaces.
[[nodiscard]] std::vector<sock_filter> call_filter();

/// Allows signals to this process. Safe between fork and exec.
void set_own_process(std::vector<sock_filter>& filter, std::uint32_t process) noexcept;

}  // namespace chladni
