// Matrices in the formats of other programs: PETSc's binary files and Matrix Market.
#pragma once

#include <Eigen/SparseCore>
#include <filesystem>

#include "base/arrays.h"

namespace chladni::io {

/// Width of the whole numbers in a PETSc file. A PETSc of 64-bit indices reads `wide` files only,
/// every other one reads `narrow` files only.
enum class PetscIndex { narrow, wide };

/// `narrow`, or `wide` where the matrix with both triangles has 2^31 entries or more.
[[nodiscard]] PetscIndex petsc_index(const SparseMatrix& lower);

/// A symmetric matrix as MatLoad reads it: both triangles by rows, columns ascending, big-endian.
/// Peak memory: a copy of `lower`.
/// @param lower  n×n, its lower triangle
/// @throws as write_atomically
/// Source: PETSc 3.18, manual page of MatLoad, "Notes for developers".
void write_petsc(const std::filesystem::path& file, const SparseMatrix& lower, PetscIndex index);

/// "coordinate real symmetric", the entries of the lower triangle, each with all its digits.
/// @throws as write_atomically
/// Source: Boisvert, Pozo and Remington (1996), The Matrix Market exchange formats, NISTIR 5935.
void write_matrix_market_symmetric(const std::filesystem::path& file, const SparseMatrix& lower);
/// "coordinate real general"; and "array real general" of a dense matrix, column by column.
void write_matrix_market(const std::filesystem::path& file, const SparseMatrix& matrix);
void write_matrix_market(const std::filesystem::path& file, const Eigen::MatrixXd& matrix);

}  // namespace chladni::io
