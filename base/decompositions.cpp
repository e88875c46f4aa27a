#include "base/decompositions.h"

namespace Eigen {

template class JacobiSVD<MatrixXd>;
template class JacobiSVD<MatrixXcd>;
template class BDCSVD<MatrixXd>;
template class ColPivHouseholderQR<MatrixXd>;
template class SelfAdjointEigenSolver<MatrixXd>;
template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, int);
template class GeneralizedSelfAdjointEigenSolver<MatrixXd>;
template class EigenSolver<MatrixXd>;
template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, bool);

}  // namespace Eigen
