#include "show/run/output_folder.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>
#include <system_error>

#include "base/error.h"
#include "host/file_lock.h"

namespace chladni::show {
namespace {

/// True if the last holder removed the lock file after we opened it and before we locked it.
bool is_stale(int descriptor) {
  struct stat status {};
  return fstat(descriptor, &status) == 0 && status.st_nlink == 0;
}

std::string holder(int descriptor) {
  std::array<char, 32> digits{};
  const auto size = pread(descriptor, digits.data(), digits.size() - 1, 0);
  std::string text(digits.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  return text.substr(0, text.find('\n'));
}

void write_own_number(int descriptor, const std::filesystem::path& folder) {
  const std::string number = fmt::to_string(getpid()) + "\n";
  if (ftruncate(descriptor, 0) == 0 &&
      pwrite(descriptor, number.data(), number.size(), 0) == static_cast<ssize_t>(number.size())) {
    return;
  }
  throw OutOfResources("cannot write to the output folder " + folder.string() + ": " +
                       reason(errno) + "; free some space or choose another with -o");
}

}  // namespace

OutputFolder::OutputFolder(const std::filesystem::path& folder)
    : folder_(folder), lock_(folder / ".chladni.lock") {
  std::error_code fault;
  std::filesystem::create_directories(folder, fault);
  std::error_code ignored;
  if (is_shortage(fault.value())) {
    throw_path_error(fault.value(), "cannot make the output folder " + folder.string());
  }
  require(std::filesystem::is_directory(folder, ignored),
          "cannot make the output folder " + folder.string() + ": " +
              (fault ? fault.message() : "something else has that name") +
              "; choose another with -o");
  do {
    descriptor_.hold(open(lock_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644));
    const int error = errno;
    const bool is_open = descriptor_.number() >= 0;
    if (!is_open && is_shortage(error)) {
      throw_path_error(error, "cannot write to the output folder " + folder.string());
    }
    require(is_open, "cannot write to the output folder " + folder.string() + ": " + reason(error) +
                         "; choose another with -o");
    if (tried_lock(descriptor_.number()) == FileLock::elsewhere) {
      throw InvalidInput("another run (process " + holder(descriptor_.number()) +
                         ") is writing to the output folder " + folder.string() +
                         "; wait for it or choose another with -o");
    }
  } while (is_stale(descriptor_.number()));
  try {
    write_own_number(descriptor_.number(), folder);
  } catch (...) {
    unlink(lock_.c_str());
    throw;
  }
}

OutputFolder::~OutputFolder() { unlink(lock_.c_str()); }

}  // namespace chladni::show
