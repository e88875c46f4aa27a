#include "host/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "base/error.h"
#include "host/unless_interrupted.h"

namespace chladni {
namespace {

[[noreturn]] void refuse_file(const std::string& name, const std::string& why) {
  throw InvalidInput(name + ": " + why + "; expected a file that can be read");
}

[[noreturn]] void refuse_for(const std::string& name, int error) {
  if (!is_shortage(error)) refuse_file(name, reason(error));
  throw OutOfResources(name + ": cannot be read: " + reason(error));
}

}  // namespace

// O_NONBLOCK: opening a pipe without a writer must not wait.
InputFile::InputFile(const std::filesystem::path& file)
    : name_(file.string()), source_(open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
  struct stat status = {};
  if (source_.number() < 0 || fstat(source_.number(), &status) != 0) refuse_for(name_, errno);
  if (S_ISDIR(status.st_mode)) refuse_file(name_, "is a folder");
  if (!S_ISREG(status.st_mode)) refuse_file(name_, "is not a regular file");
  size_ = static_cast<std::size_t>(status.st_size);
}

std::size_t InputFile::read(char* room, std::size_t size) {
  const auto count = unless_interrupted([&] { return ::read(source_.number(), room, size); });
  if (count < 0) refuse_for(name_, errno);
  return static_cast<std::size_t>(count);
}

}  // namespace chladni
