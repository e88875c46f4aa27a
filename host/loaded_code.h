// Names the code on which the bits of a computation depend.
#pragma once

#include <string>

namespace chladni {

/// The program, or the library that holds this function, and the loaded libraries that compute
/// (BLAS, LAPACK, CHOLMOD and its orderings, METIS, GMP, MPFR, the C and C++ libraries), each with
/// its build ID, or with the SHA-256 of its file where it has none; then the vector instructions of
/// the processor, by which such libraries choose among their kernels. Results of the same bits may
/// be expected only where this is the same. Cost: some 0.1 ms.
[[nodiscard]] const std::string& loaded_code();

}  // namespace chladni
