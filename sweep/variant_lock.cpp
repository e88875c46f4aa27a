#include "sweep/variant_lock.h"

#include <fcntl.h>

#include <cerrno>

#include "host/file_lock.h"

namespace chladni::sweep {

// The file stays: who removes it would take it from under one who waits for it.
VariantLock::VariantLock(const std::filesystem::path& file)
    : lock_(open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644)) {
  if (lock_.number() < 0) throw_path_error(errno, "cannot make the lock " + file.string());
  is_elsewhere_ = tried_lock(lock_.number()) == FileLock::elsewhere;
}

}  // namespace chladni::sweep
