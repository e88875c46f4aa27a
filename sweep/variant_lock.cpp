#include "sweep/variant_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "base/error.h"

namespace chladni::sweep {

// The file stays: who removes it would take it from under one who waits for it.
VariantLock::VariantLock(const std::filesystem::path& file) {
  descriptor_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (descriptor_ < 0) {
    throw OutOfResources("cannot make the lock " + file.string() + ": " +
                         std::generic_category().message(errno));
  }
  held_ = flock(descriptor_, LOCK_EX | LOCK_NB) == 0;
}

VariantLock::~VariantLock() { close(descriptor_); }

}  // namespace chladni::sweep
