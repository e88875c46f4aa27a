// Which kernel of OpenBLAS runs, and making it the right one.
#pragma once

#include <string>

namespace chladni::dense {

/// The kernel in use, as OpenBLAS names it ("SkylakeX", "Haswell", "Prescott", ...), or "unknown"
/// with another BLAS.
[[nodiscard]] std::string blas_kernel();

/// The fastest kernel of OpenBLAS that this processor can run, from CPUID; empty where the
/// processor has no AVX2.
[[nodiscard]] std::string best_blas_kernel();

/// Call first in main(). OpenBLAS 0.3.21 takes recent processors for a Pentium 4 and is then 4.8
/// times slower; the kernel is chosen while the library loads, so this sets OPENBLAS_CORETYPE and
/// starts the program again, once. Returns when the kernel is right or was chosen by the user.
void use_best_blas_kernel(char** argv);

/// Empty where the kernel is as fast as this processor allows or cannot be known; else a sentence
/// that says which one runs and how to choose the better one. For programs that are not ours.
[[nodiscard]] std::string slow_blas_kernel();

/// Threads inside BLAS calls of this process; 0 where it cannot be known.
[[nodiscard]] int blas_threads();
void set_blas_threads(int count);

/// While one of these lives, in whatever thread, BLAS works on one thread: our own loops are
/// parallel, and their bits depend on it. The last one that goes puts back what there was.
class OneBlasThread {
 public:
  OneBlasThread();
  ~OneBlasThread();
  OneBlasThread(const OneBlasThread&) = delete;
  OneBlasThread& operator=(const OneBlasThread&) = delete;
};

}  // namespace chladni::dense
