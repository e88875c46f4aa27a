// Selects the fastest kernel of OpenBLAS, and the number of BLAS threads.
#pragma once

#include <string>

namespace chladni::dense {

/// OpenBLAS's name of the kernel in use ("SkylakeX", "Haswell", "Prescott", ...), or "unknown" with
/// another BLAS.
[[nodiscard]] std::string blas_kernel();

/// The fastest kernel of OpenBLAS that this processor can run, from CPUID. Empty where the
/// processor has no AVX2.
[[nodiscard]] std::string best_blas_kernel();

/// Call this first in main(). OpenBLAS 0.3.21 treats recent processors as a Pentium 4 and is then
/// 4.8 times slower. The library chooses the kernel while it loads, so this function sets
/// OPENBLAS_CORETYPE and starts the program again, once. It returns when the kernel is right or the
/// user has chosen one.
void use_best_blas_kernel(char** argv);

/// A sentence that says which slow kernel runs and how to choose the faster one. Empty where the
/// kernel is as fast as possible on this processor or is not known. For programs that are not ours.
[[nodiscard]] std::string slow_blas_kernel();
/// The same for kernel `now` on a processor whose fastest kernel is `best`. Empty where the user
/// has chosen the kernel.
[[nodiscard]] std::string slow_blas_kernel(const std::string& now, const std::string& best,
                                           bool chosen);

/// Number of threads inside BLAS calls of this process; 0 where it is not known.
[[nodiscard]] int blas_threads();
void set_blas_threads(int count);

/// While an object of this class lives in any thread, BLAS works on one thread. The reason is that
/// our own loops are parallel, and their bits depend on it. The destructor of the last object
/// restores the old number of threads.
class OneBlasThread {
 public:
  OneBlasThread();
  ~OneBlasThread();
  OneBlasThread(const OneBlasThread&) = delete;
  OneBlasThread& operator=(const OneBlasThread&) = delete;
};

}  // namespace chladni::dense
