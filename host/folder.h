// What is in a folder, and the way to it.
#pragma once

#include <filesystem>
#include <vector>

namespace chladni {

/// Everything in `folder`, in no order; nothing where it cannot be read. Unlike the iterator of
/// libstdc++ 12, which ends the process then, it throws where there is no memory.
/// @throws std::bad_alloc
[[nodiscard]] std::vector<std::filesystem::path> entries_of(const std::filesystem::path& folder);

/// Removes a file, or a folder with all that is in it; what cannot be removed stays. A link goes,
/// and what it leads to stays. Takes no memory, so that it also tidies up where there is none:
/// libstdc++ 12 ends the process then.
void remove_whole(const std::filesystem::path& path) noexcept;

/// `target` as it is seen from `folder`. Links on both ways are followed, so that the system finds
/// it after the "..".
/// @throws std::filesystem::filesystem_error  a loop of links
[[nodiscard]] std::filesystem::path path_from(const std::filesystem::path& folder,
                                              const std::filesystem::path& target);

}  // namespace chladni
