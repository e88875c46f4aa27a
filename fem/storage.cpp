#include "fem/storage.h"

#include <sys/mman.h>

#include <algorithm>
#include <string>
#include <utility>

#include "base/error.h"

namespace chladni::fem {

Storage::Storage(std::int64_t doubles, bool resident)
    : bytes_(std::max<std::size_t>(static_cast<std::size_t>(doubles) * sizeof(double), 1)) {
  void* p = mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (p == MAP_FAILED) {
    throw OutOfResources("factorization: no " + std::to_string(bytes_ >> 20U) + " MiB to be had");
  }
  data_ = static_cast<double*>(p);
#ifdef MADV_POPULATE_WRITE
  if (resident) madvise(p, bytes_, MADV_POPULATE_WRITE);  // where the kernel has it (5.14)
#else
  (void)resident;
#endif
}

Storage::~Storage() {
  if (data_ != nullptr) munmap(data_, bytes_);
}

void Storage::swap(Storage& other) {
  std::swap(bytes_, other.bytes_);
  std::swap(data_, other.data_);
}

}  // namespace chladni::fem
