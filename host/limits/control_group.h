// The memory and processors that the control group (cgroup v2) of a process grants.
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>

namespace chladni {

/// The value of a quantity without a limit.
inline constexpr auto kUnlimited = std::numeric_limits<std::size_t>::max();

/// The kernel's files about control groups. Tests use other files.
struct ControlGroupFiles {
  std::filesystem::path membership = "/proc/self/cgroup";  ///< a line "0::/path/of/the/group"
  std::filesystem::path root = "/sys/fs/cgroup";
};

/// Bytes that the process may still take: the smallest value of memory.max less the used memory,
/// over its group and all groups above it. File pages that are not in use (inactive_file) do not
/// count as used, because the kernel frees them when memory is short. kUnlimited where nothing is
/// limited or nothing can be read.
[[nodiscard]] std::size_t memory_left_in_group(const ControlGroupFiles& files = {});

/// Processors that the process may use: cpu.max rounded up, the smallest value over its group and
/// all groups above it. kUnlimited as above.
[[nodiscard]] std::size_t processors_of_group(const ControlGroupFiles& files = {});

}  // namespace chladni
