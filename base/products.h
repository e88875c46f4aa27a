// Eigen's kernels of products and of triangular solves with dynamic matrices. They are compiled
// once, in products.cpp, and not in every file that multiplies: 79 copies of the largest were in
// the programs.
#pragma once

#include <Eigen/Core>
#include <complex>

// `how` is extern, which declares them, or nothing, which compiles them.
#define CHLADNI_MATRIX_TIMES_VECTOR(how, scalar, order, other, version)                  \
  how template struct general_matrix_vector_product<                                     \
      Index, scalar, const_blas_data_mapper<scalar, Index, order>, order, false, scalar, \
      const_blas_data_mapper<scalar, Index, other>, false, version>;
#define CHLADNI_MATRIX_TIMES_VECTORS(how, scalar)                           \
  CHLADNI_MATRIX_TIMES_VECTOR(how, scalar, RowMajor, RowMajor, Specialized) \
  CHLADNI_MATRIX_TIMES_VECTOR(how, scalar, RowMajor, RowMajor, BuiltIn)     \
  CHLADNI_MATRIX_TIMES_VECTOR(how, scalar, RowMajor, ColMajor, Specialized) \
  CHLADNI_MATRIX_TIMES_VECTOR(how, scalar, RowMajor, ColMajor, BuiltIn)     \
  CHLADNI_MATRIX_TIMES_VECTOR(how, scalar, ColMajor, RowMajor, Specialized) \
  CHLADNI_MATRIX_TIMES_VECTOR(how, scalar, ColMajor, RowMajor, BuiltIn)     \
  CHLADNI_MATRIX_TIMES_VECTOR(how, scalar, ColMajor, ColMajor, Specialized) \
  CHLADNI_MATRIX_TIMES_VECTOR(how, scalar, ColMajor, ColMajor, BuiltIn)

#define CHLADNI_TRIANGULAR(how, mode)                                                              \
  how template struct triangular_solve_matrix<double, Index, OnTheLeft, mode, false, ColMajor,     \
                                              ColMajor, 1>;                                        \
  how template struct triangular_solve_matrix<double, Index, OnTheLeft, mode, false, RowMajor,     \
                                              ColMajor, 1>;                                        \
  how template struct triangular_solve_matrix<double, Index, OnTheRight, mode, false, ColMajor,    \
                                              ColMajor, 1>;                                        \
  how template struct triangular_solve_matrix<double, Index, OnTheRight, mode, false, RowMajor,    \
                                              ColMajor, 1>;                                        \
  how template struct product_triangular_matrix_matrix<double, Index, mode, true, ColMajor, false, \
                                                       ColMajor, false, ColMajor, 1, 0>;           \
  how template struct product_triangular_matrix_matrix<double, Index, mode, true, RowMajor, false, \
                                                       ColMajor, false, ColMajor, 1, 0>;

#define CHLADNI_PRODUCTS(how)                                                                    \
  how template struct gebp_kernel<double, double, Index,                                         \
                                  blas_data_mapper<double, Index, ColMajor, Unaligned, 1>,       \
                                  RealTraits::mr, RealTraits::nr, false, false>;                 \
  how template struct gemm_pack_lhs<                                                             \
      double, Index, const_blas_data_mapper<double, Index, ColMajor>, RealTraits::mr,            \
      RealTraits::LhsProgress, RealTraits::LhsPacket4Packing, ColMajor>;                         \
  how template struct gemm_pack_lhs<                                                             \
      double, Index, const_blas_data_mapper<double, Index, RowMajor>, RealTraits::mr,            \
      RealTraits::LhsProgress, RealTraits::LhsPacket4Packing, RowMajor>;                         \
  how template struct gemm_pack_rhs<                                                             \
      double, Index, const_blas_data_mapper<double, Index, ColMajor>, RealTraits::nr, ColMajor>; \
  how template struct gemm_pack_rhs<                                                             \
      double, Index, const_blas_data_mapper<double, Index, RowMajor>, RealTraits::nr, RowMajor>; \
  how template struct gemm_pack_rhs<double, Index,                                               \
                                    blas_data_mapper<double, Index, ColMajor, Unaligned, 1>,     \
                                    RealTraits::nr, ColMajor, false, true>;                      \
  CHLADNI_MATRIX_TIMES_VECTORS(how, double)                                                      \
  CHLADNI_MATRIX_TIMES_VECTORS(how, std::complex<double>)                                        \
  CHLADNI_TRIANGULAR(how, Lower)                                                                 \
  CHLADNI_TRIANGULAR(how, Upper)                                                                 \
  CHLADNI_TRIANGULAR(how, UnitLower)                                                             \
  CHLADNI_TRIANGULAR(how, UnitUpper)

namespace Eigen::internal {

using RealTraits = gebp_traits<double, double>;

CHLADNI_PRODUCTS(extern)

}  // namespace Eigen::internal
