// A file that a command writes where it is told to.
#pragma once

#include <filesystem>

namespace chladni::app {

/// @param force  another file than `from` may be written over
/// @throws InvalidInput  `to` is the file `from`, by any name or link; or it exists
void require_new_output(const std::filesystem::path& from, const std::filesystem::path& to,
                        bool force);

}  // namespace chladni::app
