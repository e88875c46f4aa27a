// Descriptors of files, and what their errors mean.
#pragma once

#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

namespace chladni {

[[nodiscard]] inline std::string reason(int error) {
  return std::generic_category().message(error);
}

// Whether the machine ran out of a resource. Otherwise the caller named a bad place.
[[nodiscard]] inline bool is_shortage(int error) {
  return error == ENOSPC || error == EDQUOT || error == EFBIG || error == EIO || error == EMFILE ||
         error == ENFILE || error == ENOMEM;
}

// A file descriptor that is closed at the end of its scope.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() { static_cast<void>(close()); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor(Descriptor&&) = delete;
  Descriptor& operator=(Descriptor&&) = delete;

  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] int close() {
    const int closing = std::exchange(number_, -1);
    return closing < 0 ? 0 : ::close(closing);
  }

 private:
  int number_;
};

}  // namespace chladni
