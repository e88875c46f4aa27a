#include "modal/mac.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <string>

#include "base/error.h"

namespace chladni::modal {
namespace {

template <typename Matrix>
void require_shapes(const Matrix& shapes, const char* name) {
  for (Eigen::Index j = 0; j < shapes.cols(); ++j) {
    const double size = shapes.col(j).stableNorm();
    require(std::isfinite(size) && size > 0.0,
            std::string("mac: shape ") + fmt::to_string(j + 1) + " of set " + name +
                (size == 0.0 ? " is zero at every place" : " is not finite") +
                "; expected something to compare");
  }
}

template <typename Matrix>
void require_comparable(const Matrix& a, const Matrix& b) {
  require(a.rows() == b.rows(), "mac: set a has " + fmt::to_string(a.rows()) +
                                    " places and set b has " + fmt::to_string(b.rows()) +
                                    "; expected the same places in the same order");
  require_shapes(a, "a");
  require_shapes(b, "b");
}

// Columns of length 1; the stable norm avoids squares that overflow or underflow.
template <typename Matrix>
Matrix unit_columns(Matrix shapes) {
  for (Eigen::Index j = 0; j < shapes.cols(); ++j) shapes.col(j).stableNormalize();
  return shapes;
}

template <typename Matrix>
Eigen::MatrixXd mac_of(const Matrix& a, const Matrix& b) {
  require_comparable(a, b);
  const Matrix product = unit_columns(a).adjoint() * unit_columns(b);
  return product.cwiseAbs2().cwiseMin(1.0);
}

template <typename Matrix>
Matrix orthonormal_basis(const Matrix& shapes, const char* name) {
  const Eigen::ColPivHouseholderQR<Matrix> qr(unit_columns(shapes));
  require(qr.rank() == shapes.cols(), std::string("mac: the shapes of set ") + name +
                                          " are linearly dependent; expected a basis");
  return qr.householderQ() * Matrix::Identity(shapes.rows(), shapes.cols());
}

template <typename Matrix>
Eigen::VectorXd subspace_mac_of(const Matrix& a, const Matrix& b) {
  require_comparable(a, b);
  const Matrix product = orthonormal_basis(a, "a").adjoint() * orthonormal_basis(b, "b");
  return Eigen::JacobiSVD<Matrix>(product).singularValues().cwiseAbs2().cwiseMin(1.0);
}

template <typename Matrix>
Eigen::VectorXd comac_of(const Matrix& a, const Matrix& b) {
  require(a.rows() == b.rows() && a.cols() == b.cols(),
          "comac: set a is " + fmt::to_string(a.rows()) + " places by " + fmt::to_string(a.cols()) +
              " modes, set b " + fmt::to_string(b.rows()) + " by " + fmt::to_string(b.cols()) +
              "; expected paired modes at the same places");
  require(a.allFinite() && b.allFinite(), "comac: a shape is not finite");
  Eigen::VectorXd result(a.rows());
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    const double both = a.row(i).cwiseAbs().dot(b.row(i).cwiseAbs());
    const double sizes = a.row(i).norm() * b.row(i).norm();
    const bool one_is_zero = a.row(i).isZero(0.0) != b.row(i).isZero(0.0);
    result(i) = sizes > 0.0 ? both * both / (sizes * sizes) : one_is_zero ? 0.0 : 1.0;
  }
  return result;
}

}  // namespace

Eigen::MatrixXd mac(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return mac_of(a, b); }
Eigen::MatrixXd mac(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b) { return mac_of(a, b); }
Eigen::MatrixXd auto_mac(const Eigen::MatrixXd& a) { return mac_of(a, a); }
Eigen::MatrixXd auto_mac(const Eigen::MatrixXcd& a) { return mac_of(a, a); }

Eigen::VectorXd subspace_mac(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return subspace_mac_of(a, b);
}
Eigen::VectorXd subspace_mac(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b) {
  return subspace_mac_of(a, b);
}

Eigen::VectorXd comac(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return comac_of(a, b); }
Eigen::VectorXd comac(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b) {
  return comac_of(a, b);
}

}  // namespace chladni::modal
