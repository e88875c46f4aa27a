// Matrices that come from data, looked at before an iteration works on them.
#pragma once

#include <Eigen/Core>

namespace chladni {

/// What `finite` says of a matrix with entries that are not.
/// @throws NumericalFailure  always
[[noreturn]] void refuse_infinite(const char* name, Eigen::Index bad, Eigen::Index size);

/// The matrix itself where every entry is a finite number. Eigen's iterations on anything else may
/// never end, or read outside of their arrays.
/// @param name  what the matrix is, as the message names it
/// @throws NumericalFailure  an entry is infinite or not a number; tells how many
template <typename Matrix>
const Matrix& finite(const Matrix& matrix, const char* name) {
  if (matrix.allFinite()) return matrix;
  refuse_infinite(name, matrix.size() - matrix.array().isFinite().count(), matrix.size());
}

}  // namespace chladni
