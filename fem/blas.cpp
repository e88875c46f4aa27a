// The only file that knows OpenBLAS.
#include "fem/blas.h"

#include <unistd.h>

#include <array>
#include <cstdlib>
#include <string_view>

// Declared here and weak, so that another BLAS still links.
extern "C" {
char* openblas_get_corename() __attribute__((weak));
void openblas_set_num_threads(int) __attribute__((weak));
}

namespace chladni::fem {

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
  constexpr auto variable = "OPENBLAS_CORETYPE";
  // Kernels as good as the best for a processor with AVX2 but no AVX-512.
  constexpr std::array<std::string_view, 4> as_good{"Haswell", "Zen", "Excavator", "SkylakeX"};
  const std::string now = blas_kernel();
  const std::string best = best_blas_kernel();
  if (now == "unknown" || best.empty() || now == best || now == "Cooperlake" ||
      now == "Sapphirerapids" || std::getenv(variable) != nullptr) {
    return;
  }
  if (best == "Haswell") {
    for (const auto kernel : as_good) {
      if (now == kernel) return;
    }
  }
  setenv(variable, best.c_str(), 1);
  execv("/proc/self/exe", argv);  // returns only where that failed: then the slow kernel must do
}

void set_blas_threads(int count) {
  if (openblas_set_num_threads != nullptr) openblas_set_num_threads(count);
}

}  // namespace chladni::fem
