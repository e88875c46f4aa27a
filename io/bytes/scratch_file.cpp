#include "io/bytes/scratch_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string>

#include "base/error.h"
#include "host/held_signal.h"
#include "host/unless_interrupted.h"

namespace chladni::io {
namespace {

std::string folder() {
  const char* named = std::getenv("TMPDIR");
  return named != nullptr && *named != '\0' ? named : "/var/tmp";
}

[[noreturn]] void fail(const std::string& what) {
  throw OutOfResources("a scratch file in " + folder() + " " + what + ": " + std::strerror(errno) +
                       "; a recording larger than the memory needs one, set TMPDIR to a folder on "
                       "a disk with room");
}

// Some file systems have no files without a name.
int made_and_unlinked(const std::string& where) {
  std::string name = where + "/chladni_XXXXXX";
  const int file = mkostemp(name.data(), O_CLOEXEC);
  if (file >= 0) unlink(name.c_str());
  return file;
}

}  // namespace

ScratchFile::ScratchFile() {
  const auto where = folder();
  file_ = open(where.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file_ < 0) file_ = made_and_unlinked(where);
  if (file_ < 0) fail("cannot be made");
}

ScratchFile::~ScratchFile() { close(file_); }

std::uint64_t ScratchFile::append(const double* numbers, std::size_t count) {
  const HeldSignal held(SIGXFSZ);  // of a limit on the size of files: the write fails instead
  const auto start = size_;
  const char* bytes = reinterpret_cast<const char*>(numbers);
  for (std::size_t left = count * sizeof(double); left > 0;) {
    const auto written =
        unless_interrupted([&] { return pwrite(file_, bytes, left, static_cast<off_t>(size_)); });
    if (written <= 0) fail("cannot be written");
    bytes += written;
    left -= static_cast<std::size_t>(written);
    size_ += static_cast<std::uint64_t>(written);
  }
  return start;
}

void ScratchFile::read(std::uint64_t at, double* numbers, std::size_t count) const {
  char* bytes = reinterpret_cast<char*>(numbers);
  for (std::size_t left = count * sizeof(double); left > 0;) {
    const auto got =
        unless_interrupted([&] { return pread(file_, bytes, left, static_cast<off_t>(at)); });
    if (got <= 0) fail("cannot be read");
    bytes += got;
    left -= static_cast<std::size_t>(got);
    at += static_cast<std::uint64_t>(got);
  }
}

}  // namespace chladni::io
