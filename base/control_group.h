// What the control group (cgroup v2) of a process grants it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>

namespace chladni {

/// What is not limited.
inline constexpr auto kUnlimited = std::numeric_limits<std::size_t>::max();

/// Where the kernel tells of groups; other places serve tests.
struct ControlGroupFiles {
  std::filesystem::path membership = "/proc/self/cgroup";  ///< a line "0::/path/of/the/group"
  std::filesystem::path root = "/sys/fs/cgroup";
};

/// Bytes that the process may still take: the least of memory.max less what is used over its group
/// and all above it. File pages that are not in use (inactive_file) are given back when memory is
/// short and do not count as used. kUnlimited where nothing is limited or nothing can be read.
[[nodiscard]] std::size_t memory_left_in_group(const ControlGroupFiles& files = {});

/// Processors' worth of time per second, cpu.max rounded up: the least over its group and all above
/// it. kUnlimited as above.
[[nodiscard]] std::size_t processors_of_group(const ControlGroupFiles& files = {});

}  // namespace chladni
