#include "host/file_lock.h"

#include <sys/file.h>

#include <cerrno>

#include "base/error.h"
#include "host/descriptor.h"

namespace chladni {

FileLock tried_lock(int descriptor) {
  return lock_after(flock(descriptor, LOCK_EX | LOCK_NB) == 0 ? 0 : errno);
}

FileLock lock_after(int error) {
  if (error == 0) return FileLock::held;
  return error == EWOULDBLOCK ? FileLock::elsewhere : FileLock::none;
}

void throw_path_error(int error, const std::string& what) {
  const std::string text = what + ": " + reason(error);
  if (is_shortage(error)) throw OutOfResources(text);
  throw InvalidInput(text + "; expected a path that can be used");
}

}  // namespace chladni
