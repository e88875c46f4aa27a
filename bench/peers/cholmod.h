// CHOLMOD's supernodal Cholesky on the same matrix, as a peer.
#pragma once

#include "base/arrays.h"

namespace chladni::bench {

/// Analyses and factorises K + s M with METIS; returns the entries of the factor.
[[nodiscard]] double cholmod_entries(const SparseMatrix& stiffness, double s,
                                     const SparseMatrix& mass);

}  // namespace chladni::bench
