#include "base/decompositions.h"

namespace Eigen {

template class JacobiSVD<MatrixXd>;
template class JacobiSVD<MatrixXcd>;
template class BDCSVD<MatrixXd>;
template class ColPivHouseholderQR<MatrixXd>;
template void ColPivHouseholderQR<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const;
template void ColPivHouseholderQR<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
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
template class LDLT<MatrixXd>;
template LDLT<MatrixXd>& LDLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
template class SelfAdjointEigenSolver<MatrixXd>;
template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, int);
template class GeneralizedSelfAdjointEigenSolver<MatrixXd>;
template class EigenSolver<MatrixXd>;
template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, bool);

}  // namespace Eigen
