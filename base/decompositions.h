// Eigen's decompositions of dynamic matrices. They are compiled once, in decompositions.cpp, and
// not in every file that calls them. Such a file then compiles in 1 to 2 s instead of 5 to 20 s, if
// it gives them matrices: a decomposition or a solve of an expression (a product, say) is an
// instance of its own. The test `instances` (cmake/check_instances.py) lists such.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

#include "base/products.h"

namespace Eigen {

extern template class JacobiSVD<MatrixXd>;
extern template class JacobiSVD<MatrixXcd>;
extern template class HouseholderQR<MatrixXd>;
extern template void HouseholderQR<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;
extern template class ColPivHouseholderQR<MatrixXd>;
extern template void ColPivHouseholderQR<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;
extern template void ColPivHouseholderQR<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
extern template class ColPivHouseholderQR<MatrixXcd>;
extern template class CompleteOrthogonalDecomposition<MatrixXd>;
extern template void CompleteOrthogonalDecomposition<MatrixXd>::_solve_impl(const MatrixXd&,
                                                                            MatrixXd&) const;
extern template void CompleteOrthogonalDecomposition<MatrixXd>::_solve_impl(const VectorXd&,
                                                                            VectorXd&) const;
extern template class PartialPivLU<MatrixXd>;
extern template class PartialPivLU<MatrixXcd>;
extern template PartialPivLU<MatrixXd>::PartialPivLU(const EigenBase<MatrixXd>&);
extern template PartialPivLU<MatrixXcd>::PartialPivLU(const EigenBase<MatrixXcd>&);
extern template class LLT<MatrixXd>;
extern template LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
extern template void LLT<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;
extern template void LLT<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
extern template double internal::rcond_estimate_helper(double, const LLT<MatrixXd>&);
extern template class LDLT<MatrixXd>;
extern template LDLT<MatrixXd>& LDLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
extern template void LDLT<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;
extern template void LDLT<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
extern template double internal::rcond_estimate_helper(double, const LDLT<MatrixXd>&);
extern template class SelfAdjointEigenSolver<MatrixXd>;
extern template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, int);
extern template class SelfAdjointEigenSolver<Matrix3d>;
extern template SelfAdjointEigenSolver<Matrix3d>& SelfAdjointEigenSolver<Matrix3d>::compute(
    const EigenBase<Matrix3d>&, int);
extern template class GeneralizedSelfAdjointEigenSolver<MatrixXd>;
extern template class EigenSolver<MatrixXd>;
extern template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&,
                                                                      bool);

}  // namespace Eigen
