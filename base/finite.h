// Matrices that come from data, looked at before an iteration works on them.
#pragma once

#include <Eigen/Core>
#include <string>

#include "base/error.h"

namespace chladni {

/// The matrix itself where every entry is a finite number. Eigen's iterations on anything else may
/// never end, or read outside of their arrays.
/// @param name  what the matrix is, as the message names it
/// @throws NumericalFailure  an entry is infinite or not a number; tells how many
template <typename Matrix>
const Matrix& finite(const Matrix& matrix, const char* name) {
  if (matrix.allFinite()) return matrix;
  const auto bad = matrix.size() - matrix.array().isFinite().count();
  throw NumericalFailure(std::string(name) + ": " + std::to_string(bad) + " of " +
                         std::to_string(matrix.size()) +
                         " entries are infinite or no numbers; expected finite values (are the "
                         "data of a sound size?)");
}

}  // namespace chladni
