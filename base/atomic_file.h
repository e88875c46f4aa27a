// Files that appear whole or not at all.
#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <string_view>

namespace chladni {

/// Writes through `fill` to a temporary name in the same folder, syncs, and renames onto `file`.
/// Until the rename the old file stands; after any failure no temporary file is left.
/// @throws InvalidInput    the folder does not exist or cannot be written (names it)
/// @throws OutOfResources  the disk is full or the write failed (names file and reason)
void write_atomically(const std::filesystem::path& file,
                      const std::function<void(std::ostream&)>& fill);
void write_atomically(const std::filesystem::path& file, std::string_view content);

/// The same for a library that insists on a path of its own: `fill` gets the temporary path (same
/// extension as `file`).
void write_atomically_at(const std::filesystem::path& file,
                         const std::function<void(const std::filesystem::path&)>& fill);

/// The whole of a regular file, as bytes.
/// @throws InvalidInput    it does not exist, is not a regular file, cannot be read or exceeds
///                         `limit`
/// @throws OutOfResources  no memory for it
[[nodiscard]] std::string read_whole(const std::filesystem::path& file,
                                     std::size_t limit = std::size_t{4} << 30U);

}  // namespace chladni
