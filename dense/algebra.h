// Dense matrices at the speed of BLAS and LAPACK.
#pragma once

#include <Eigen/Core>
#include <complex>

namespace chladni::dense {

/// A = LLᵀ in place, lower triangle. False where a pivot is not positive.
[[nodiscard]] bool cholesky(Eigen::MatrixXd& a);

/// B := L⁻¹ B and B := L⁻ᵀ B.
void solve(const Eigen::MatrixXd& factor, Eigen::MatrixXd& b);
void solve_transposed(const Eigen::MatrixXd& factor, Eigen::MatrixXd& b);

/// Lower triangle of A⁻¹ from the lower triangle of L, in place.
void invert(Eigen::MatrixXd& factor);

/// C := C + s A Aᵀ, lower triangle only.
void add_square(const Eigen::MatrixXd& a, double s, Eigen::MatrixXd& c);

/// C := C + Aᵀ A, lower triangle only; A is r×n, C n×n.
void add_gram(const Eigen::Ref<const Eigen::MatrixXd>& a, Eigen::MatrixXd& c);

/// An orthonormal basis of the span of A (m×n, n ≤ m, of full rank): the first n columns of Q in
/// A = QR by Householder's reflections. By Eigen, so that the bits are the same for every BLAS.
[[nodiscard]] Eigen::MatrixXd orthonormal_basis(const Eigen::MatrixXd& a);

/// A⁺ (n×m) of A (m×n) by a complete orthogonal decomposition: the least solution of least squares.
/// By Eigen, like the basis.
[[nodiscard]] Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& a);

/// The inverse of a matrix through its factor, an `Eigen::LLT` or `LDLT` of it; of a tall matrix
/// through its QR decomposition the left inverse. One vector is better solved for.
template <typename Factor>
[[nodiscard]] Eigen::MatrixXd inverse_of(const Factor& factor) {
  const Eigen::MatrixXd units = Eigen::MatrixXd::Identity(factor.rows(), factor.rows());
  return factor.solve(units);
}

/// C := C + s A B.
void add_product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double s, Eigen::MatrixXd& c);

/// C := C + s Aᵀ B of complex matrices, without conjugation; A is r×m, B r×n, C m×n.
void add_transposed_product(const Eigen::Ref<const Eigen::MatrixXcd>& a,
                            const Eigen::Ref<const Eigen::MatrixXcd>& b, std::complex<double> s,
                            Eigen::MatrixXcd& c);

}  // namespace chladni::dense
