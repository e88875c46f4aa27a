// Which kernel of OpenBLAS runs, and making it the right one.
#pragma once

#include <string>

namespace chladni::fem {

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

/// Threads inside BLAS calls; one where our own loops are parallel.
void set_blas_threads(int count);

}  // namespace chladni::fem
