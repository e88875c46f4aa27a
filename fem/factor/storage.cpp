#include "fem/factor/storage.h"

#include <fmt/format.h>

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/interrupt.h"

namespace chladni::fem {

Storage::Storage(std::int64_t doubles, bool resident)
    : bytes_(std::max<std::size_t>(static_cast<std::size_t>(doubles) * sizeof(double), 1)) {
  void* p = mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (p == MAP_FAILED) {
    throw OutOfResources("factorization: no " + fmt::to_string(bytes_ >> 20U) + " MiB to be had");
  }
  data_ = static_cast<double*>(p);
#ifdef MADV_POPULATE_WRITE
  constexpr std::size_t piece = std::size_t{1} << 28U;  // a tenth of a second
  for (std::size_t done = 0; resident && done < bytes_; done += piece) {
    if (interrupted()) break;  // the first step of work on the array throws Interrupted
    // Works where the kernel has it (5.14); elsewhere it does nothing.
    madvise(static_cast<char*>(p) + done, std::min(piece, bytes_ - done), MADV_POPULATE_WRITE);
  }
#else
  (void)resident;
#endif
}

Storage::~Storage() {
  if (data_ != nullptr) munmap(data_, bytes_);
}

void Storage::shrink(std::int64_t doubles) {
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  const auto wanted = std::max<std::size_t>(static_cast<std::size_t>(doubles) * sizeof(double), 1);
  const auto kept = (wanted + page - 1) / page * page;
  if (kept >= bytes_) return;
  munmap(reinterpret_cast<char*>(data_) + kept, bytes_ - kept);
  bytes_ = kept;
}

void Storage::swap(Storage& other) {
  std::swap(bytes_, other.bytes_);
  std::swap(data_, other.data_);
}

}  // namespace chladni::fem
