// The only file that calls functions of OpenBLAS itself.
#include "dense/blas.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <mutex>
#include <string_view>

// These declarations are weak, so that the program also links with another BLAS.
extern "C" {
char* openblas_get_corename() __attribute__((weak));
void openblas_set_num_threads(int) __attribute__((weak));
int openblas_get_num_threads() __attribute__((weak));
}

namespace chladni::dense {
namespace {

constexpr auto kVariable = "OPENBLAS_CORETYPE";

// Whether kernel `now` is as fast as the kernel `best` of this processor.
bool is_as_good(const std::string& now, const std::string& best) {
  // For a processor with AVX2 but no AVX-512.
  constexpr std::array<std::string_view, 4> with_avx2{"Haswell", "Zen", "Excavator", "SkylakeX"};
  if (now == "unknown" || best.empty() || now == best || now == "Cooperlake" ||
      now == "Sapphirerapids") {
    return true;
  }
  return best == "Haswell" && std::find(with_avx2.begin(), with_avx2.end(), now) != with_avx2.end();
}

// The number of living OneBlasThread objects, and the number of threads before the first one.
struct Holders {
  std::mutex mutex;
  int count = 0;
  int before = 0;
};
Holders& holders() {
  static Holders all;
  return all;
}

}  // namespace

std::string blas_kernel() {
  return openblas_get_corename == nullptr ? "unknown" : openblas_get_corename();
}

std::string best_blas_kernel() {
  __builtin_cpu_init();
  const bool avx2 = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
  const bool avx512 =
      __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
      __builtin_cpu_supports("avx512bw") != 0 && __builtin_cpu_supports("avx512vl") != 0;
  if (avx512) return "SkylakeX";
  return avx2 ? "Haswell" : "";
}

void use_best_blas_kernel(char** argv) {
  if (slow_blas_kernel().empty()) return;
  setenv(kVariable, best_blas_kernel().c_str(), 1);
  execv("/proc/self/exe", argv);  // returns only on failure; the slow kernel is used then
}

std::string slow_blas_kernel() {
  return slow_blas_kernel(blas_kernel(), best_blas_kernel(), std::getenv(kVariable) != nullptr);
}

std::string slow_blas_kernel(const std::string& now, const std::string& best, bool chosen) {
  if (chosen || is_as_good(now, best)) return "";
  return "OpenBLAS runs its kernel \"" + now + "\", which is up to five times slower here than \"" +
         best + "\": set " + kVariable + "=" + best + " before the program starts";
}

int blas_threads() { return openblas_get_num_threads == nullptr ? 0 : openblas_get_num_threads(); }

void set_blas_threads(int count) {
  if (openblas_set_num_threads != nullptr) openblas_set_num_threads(count);
}

OneBlasThread::OneBlasThread() {
  auto& scopes = holders();
  const std::lock_guard lock(scopes.mutex);
  if (scopes.count++ > 0) return;
  scopes.before = blas_threads();
  set_blas_threads(1);
}

OneBlasThread::~OneBlasThread() {
  auto& scopes = holders();
  const std::lock_guard lock(scopes.mutex);
  if (--scopes.count == 0 && scopes.before > 0) set_blas_threads(scopes.before);
}

}  // namespace chladni::dense
