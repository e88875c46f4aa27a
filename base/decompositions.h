// Eigen's decompositions of matrices of any size, compiled once (decompositions.cpp) instead of in
// every file that calls them: a second or two instead of five to twenty.
#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace Eigen {

extern template class JacobiSVD<MatrixXd>;
extern template class JacobiSVD<MatrixXcd>;
extern template class BDCSVD<MatrixXd>;
extern template class ColPivHouseholderQR<MatrixXd>;
extern template class SelfAdjointEigenSolver<MatrixXd>;
extern template SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, int);
extern template class GeneralizedSelfAdjointEigenSolver<MatrixXd>;
extern template class EigenSolver<MatrixXd>;
extern template EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&,
                                                                      bool);

}  // namespace Eigen
