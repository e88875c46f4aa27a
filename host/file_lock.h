// Locks on files that several runs may share.
#pragma once

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

}  // namespace chladni
