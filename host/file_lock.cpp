#include "host/file_lock.h"

#include <sys/file.h>

#include <cerrno>

namespace chladni {

FileLock tried_lock(int descriptor) {
  return lock_after(flock(descriptor, LOCK_EX | LOCK_NB) == 0 ? 0 : errno);
}

FileLock lock_after(int error) {
  if (error == 0) return FileLock::held;
  return error == EWOULDBLOCK ? FileLock::elsewhere : FileLock::none;
}

}  // namespace chladni
