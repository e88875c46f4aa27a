// Check of a user-named output file.
#pragma once

#include <filesystem>

namespace chladni::show {

/// @param force  allows to overwrite any file except `from`
/// @throws InvalidInput  `to` is the file `from`, by any name or link; or it exists without `force`
void require_new_output(const std::filesystem::path& from, const std::filesystem::path& to,
                        bool force);

}  // namespace chladni::show
