// The arrays that the rooms exchange. All lengths are in m, all values in SI units.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstdint>

namespace chladni {

/// One row per point, columns x y z [m]. The array is row-major, so NumPy and VTK view it without a
/// copy.
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// One row per cell. Entries are row numbers of a Points array. There are 3, 6, 10 (faces) or 4,
/// 10, 20 (tetrahedra) columns in VTK's node order.
using Cells = Eigen::Matrix<std::int32_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Column-compressed. A symmetric matrix stores its lower triangle only, rows ascending in each
/// column; use it through `.selfadjointView<Eigen::Lower>()`.
using SparseMatrix = Eigen::SparseMatrix<double>;

}  // namespace chladni
