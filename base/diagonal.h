// The size of a set of points.
#pragma once

#include "base/arrays.h"

namespace chladni {

/// Diagonal of the least box along x, y and z that holds all points [m]; 0 of no point.
/// @param points  n×3, 0 rows or more
[[nodiscard]] inline double diagonal_of(const Points& points) {
  if (points.rows() == 0) return 0.0;
  return (points.colwise().maxCoeff() - points.colwise().minCoeff()).norm();
}

}  // namespace chladni
