// What is in a folder.
#pragma once

#include <filesystem>
#include <vector>

namespace chladni {

/// Everything in `folder`, in no order; nothing where it cannot be read. Unlike the iterator of
/// libstdc++ 12, which ends the process then, it throws where there is no memory.
/// @throws std::bad_alloc
[[nodiscard]] std::vector<std::filesystem::path> entries_of(const std::filesystem::path& folder);

}  // namespace chladni
