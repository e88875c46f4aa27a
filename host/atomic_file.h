// Writes files so that they appear whole or not at all.
#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <string_view>

namespace chladni {

/// `fill` writes to a temporary file in the same folder. This file is synced and renamed to `file`.
/// Until the rename the old file stays; after a failure no temporary file is left.
/// @throws InvalidInput    the folder does not exist or cannot be written (names it)
/// @throws OutOfResources  the disk is full or the write failed (names file and reason)
void write_atomically(const std::filesystem::path& file,
                      const std::function<void(std::ostream&)>& fill);
void write_atomically(const std::filesystem::path& file, std::string_view content);

/// Like write_atomically, for a library that needs a path: `fill` gets the temporary path, which
/// has the same extension as `file`.
void write_atomically_at(const std::filesystem::path& file,
                         const std::function<void(const std::filesystem::path&)>& fill);

/// All bytes of a regular file.
/// @throws InvalidInput    the file does not exist, is not a regular file, cannot be read or
///                         exceeds `limit`
/// @throws OutOfResources  there is no memory for the bytes, or the disk or the machine fails
[[nodiscard]] std::string read_whole(const std::filesystem::path& file,
                                     std::size_t limit = std::size_t{4} << 30U);

}  // namespace chladni
