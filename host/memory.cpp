#include "host/memory.h"

#include <fmt/format.h>
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <limits>
#include <string>

#include "base/error.h"
#include "host/limits/control_group.h"

namespace chladni {
namespace {

constexpr auto kUnknown = kUnlimited;

// The number in a file that holds one; `kUnknown` for "max" or no file.
std::size_t pages_in(const char* file) {
  std::ifstream in(file);
  std::size_t value = kUnknown;
  return in >> value ? value : kUnknown;
}

std::size_t kernel_available() {
  std::ifstream in("/proc/meminfo");
  for (std::string key; in >> key;) {
    std::size_t kib = 0;
    if (key == "MemAvailable:" && in >> kib) return kib * 1024;
    in.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return kUnknown;
}

// The rest of the address space under the limit of `ulimit -v`.
std::size_t left_in_limit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kUnknown;
  const auto pages = pages_in("/proc/self/statm");
  if (pages == kUnknown) return kUnknown;
  const std::size_t used = pages * static_cast<std::size_t>(sysconf(_SC_PAGE_SIZE));
  return limit.rlim_cur > used ? limit.rlim_cur - used : 0;
}

}  // namespace

std::size_t available_memory() {
  const auto least = std::min({kernel_available(), memory_left_in_group(), left_in_limit()});
  if (least != kUnknown) return least;
  return static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) *
         static_cast<std::size_t>(sysconf(_SC_PAGE_SIZE));
}

std::size_t bytes_of_gigabytes(double gigabytes) {
  constexpr double kMost = 0x1p63;
  require(gigabytes >= 0.0,
          fmt::format("a limit of memory of {:.6g} GB; expected 0 or more", gigabytes));
  return static_cast<std::size_t>(std::min(1e9 * gigabytes, kMost));
}

void release_freed_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace chladni
