// Descriptors of files, and what their errors mean.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "base/error.h"

namespace chladni {

[[nodiscard]] inline std::string reason(int error) {
  return std::generic_category().message(error);
}

// Whether the machine ran out of a resource. Otherwise the caller named a bad place.
[[nodiscard]] inline bool is_shortage(int error) {
  return error == ENOSPC || error == EDQUOT || error == EFBIG || error == EIO || error == EMFILE ||
         error == ENFILE || error == ENOMEM;
}

// The error of a path that cannot be made, opened or locked. @param error  errno
// @throws OutOfResources  a shortage; InvalidInput  else
[[noreturn]] inline void throw_path_error(int error, const std::string& what) {
  const std::string text = what.empty() ? reason(error) : what + ": " + reason(error);
  if (is_shortage(error)) throw OutOfResources(text);
  throw InvalidInput(text + "; expected a path that can be used");
}
[[noreturn]] inline void throw_path_error(const std::filesystem::filesystem_error& e) {
  throw_path_error(e.code().value(), e.path1().string());
}

// Moves a descriptor that has the number of a standard stream to a higher one, closed on exec. A
// process that starts with a closed stream would else give that number to its next file, and the
// streams of its children would overwrite the file. −1 where that fails; then it is closed too.
[[nodiscard]] inline int above_standard(int number) noexcept {
  if (number < 0 || number > STDERR_FILENO) return number;
  const int moved = fcntl(number, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  const int error = errno;
  ::close(number);
  errno = error;
  return moved;
}

// A file descriptor that is closed at the end of its scope.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  ~Descriptor() { static_cast<void>(close()); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor(Descriptor&&) = delete;
  Descriptor& operator=(Descriptor&&) = delete;

  [[nodiscard]] int number() const { return number_; }
  void hold(int number) {
    static_cast<void>(close());
    number_ = number;
  }
  [[nodiscard]] int close() {
    const int closing = std::exchange(number_, -1);
    return closing < 0 ? 0 : ::close(closing);
  }

 private:
  int number_;
};

}  // namespace chladni
