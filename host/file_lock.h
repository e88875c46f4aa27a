// Locks on files that several runs may share, and what an error on a path means.
#pragma once

#include <string>

namespace chladni {

enum class FileLock {
  held,       ///< by this process
  elsewhere,  ///< by another process
  none,       ///< the file system has no locks
};

/// Tries flock on an open file, without waiting. The lock ends with the descriptor.
[[nodiscard]] FileLock tried_lock(int descriptor);

/// What an error of flock says. @param error  errno; 0: there was none
[[nodiscard]] FileLock lock_after(int error);

/// The error of a path that cannot be made, opened or locked. @param error  errno
/// @throws OutOfResources  the machine lacks room, descriptors or memory, or a disk fails
/// @throws InvalidInput    else: the place is a bad one
[[noreturn]] void throw_path_error(int error, const std::string& what);

}  // namespace chladni
