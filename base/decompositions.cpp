#include "base/decompositions.h"

namespace Eigen {

template class JacobiSVD<MatrixXd>;
template class JacobiSVD<MatrixXcd>;
template class HouseholderQR<MatrixXd>;
template void HouseholderQR<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;
template class ColPivHouseholderQR<MatrixXd>;
template void ColPivHouseholderQR<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;
template void ColPivHouseholderQR<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
template class ColPivHouseholderQR<MatrixXcd>;
template class CompleteOrthogonalDecomposition<MatrixXd>;
template void CompleteOrthogonalDecomposition<MatrixXd>::_solve_impl(const MatrixXd&,
                                                                     MatrixXd&) const;
template void CompleteOrthogonalDecomposition<MatrixXd>::_solve_impl(const VectorXd&,
                                                                     VectorXd&) const;
template class PartialPivLU<MatrixXd>;
template class PartialPivLU<MatrixXcd>;
template PartialPivLU<MatrixXd>::PartialPivLU(const EigenBase<MatrixXd>&);
template PartialPivLU<MatrixXcd>::PartialPivLU(const EigenBase<MatrixXcd>&);
template class LLT<MatrixXd>;
template LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
template void LLT<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;
template void LLT<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
template double internal::rcond_estimate_helper(double, const LLT<MatrixXd>&);
template class LDLT<MatrixXd>;
template LDLT<MatrixXd>& LDLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
template void LDLT<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;
template void LDLT<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
template double internal::rcond_estimate_helper(double, const LDLT<MatrixXd>&);
template class SelfAdjointEigenSolver<MatrixXd>;
template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, int);
template class SelfAdjointEigenSolver<Matrix3d>;
template SelfAdjointEigenSolver<Matrix3d>& SelfAdjointEigenSolver<Matrix3d>::compute(
    const EigenBase<Matrix3d>&, int);
template class GeneralizedSelfAdjointEigenSolver<MatrixXd>;
template class EigenSolver<MatrixXd>;
template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, bool);

}  // namespace Eigen
