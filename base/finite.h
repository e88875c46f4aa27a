// Checks matrices from data before an iteration works on them.
#pragma once

#include <Eigen/Core>

namespace chladni {

/// Throws the exception of `finite` for a matrix with entries that are not finite.
/// @throws NumericalFailure  always
[[noreturn]] void refuse_infinite(const char* name, Eigen::Index bad, Eigen::Index size);

/// Returns the matrix itself if every entry is a finite number. With other entries Eigen's
/// iterations may never end or may read outside their arrays.
/// @param name  the name of the matrix in the message
/// @throws NumericalFailure  an entry is infinite or not a number; says how many
template <typename Matrix>
const Matrix& finite(const Matrix& matrix, const char* name) {
  if (matrix.allFinite()) return matrix;
  refuse_infinite(name, matrix.size() - matrix.array().isFinite().count(), matrix.size());
}

}  // namespace chladni
