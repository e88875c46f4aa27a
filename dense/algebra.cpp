#include "dense/algebra.h"

#include <Eigen/QR>

#include "dense/flush_to_zero.h"
#include "dense/fortran.h"

namespace chladni::dense {
namespace {

int fortran_size(Eigen::Index n) { return static_cast<int>(n); }

void triangular_solve(const char* transposed, const Eigen::MatrixXd& factor, Eigen::MatrixXd& b) {
  if (b.size() == 0) return;
  const FlushToZero flush;
  constexpr double kOne = 1.0;
  const int m = fortran_size(b.rows());
  const int n = fortran_size(b.cols());
  dtrsm_("L", "L", transposed, "N", &m, &n, &kOne, factor.data(), &m, b.data(), &m);
}

}  // namespace

bool cholesky(Eigen::MatrixXd& a) {
  const FlushToZero flush;
  const int n = fortran_size(a.rows());
  int info = 0;
  if (n > 0) dpotrf_("L", &n, a.data(), &n, &info);
  return info == 0;
}

void solve(const Eigen::MatrixXd& factor, Eigen::MatrixXd& b) { triangular_solve("N", factor, b); }

void solve_transposed(const Eigen::MatrixXd& factor, Eigen::MatrixXd& b) {
  triangular_solve("T", factor, b);
}

void invert(Eigen::MatrixXd& factor) {
  const FlushToZero flush;
  const int n = fortran_size(factor.rows());
  int info = 0;
  if (n > 0) dpotri_("L", &n, factor.data(), &n, &info);
}

void add_square(const Eigen::MatrixXd& a, double s, Eigen::MatrixXd& c) {
  if (a.size() == 0) return;
  const FlushToZero flush;
  constexpr double kOne = 1.0;
  const int n = fortran_size(a.rows());
  const int k = fortran_size(a.cols());
  dsyrk_("L", "N", &n, &k, &s, a.data(), &n, &kOne, c.data(), &n);
}

void add_gram(const Eigen::Ref<const Eigen::MatrixXd>& a, Eigen::MatrixXd& c) {
  if (a.size() == 0) return;
  const FlushToZero flush;
  constexpr double kOne = 1.0;
  const int n = fortran_size(a.cols());
  const int k = fortran_size(a.rows());
  const int stride = fortran_size(a.outerStride());
  dsyrk_("L", "T", &n, &k, &kOne, a.data(), &stride, &kOne, c.data(), &n);
}

Eigen::MatrixXd orthonormal_basis(const Eigen::MatrixXd& a) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(a).householderQ() *
         Eigen::MatrixXd::Identity(a.rows(), a.cols());
}

Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& a) {
  const Eigen::MatrixXd each_row = Eigen::MatrixXd::Identity(a.rows(), a.rows());
  return Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(a).solve(each_row);
}

void add_product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double s, Eigen::MatrixXd& c) {
  if (a.size() == 0 || b.size() == 0) return;
  const FlushToZero flush;
  constexpr double kOne = 1.0;
  const int m = fortran_size(a.rows());
  const int n = fortran_size(b.cols());
  const int k = fortran_size(a.cols());
  dgemm_("N", "N", &m, &n, &k, &s, a.data(), &m, b.data(), &k, &kOne, c.data(), &m);
}

void add_transposed_product(const Eigen::Ref<const Eigen::MatrixXcd>& a,
                            const Eigen::Ref<const Eigen::MatrixXcd>& b, std::complex<double> s,
                            Eigen::MatrixXcd& c) {
  if (a.size() == 0 || b.size() == 0) return;
  const FlushToZero flush;
  constexpr std::complex<double> kOne = 1.0;
  const int m = fortran_size(a.cols());
  const int n = fortran_size(b.cols());
  const int k = fortran_size(a.rows());
  const int stride_a = fortran_size(a.outerStride());
  const int stride_b = fortran_size(b.outerStride());
  zgemm_("T", "N", &m, &n, &k, &s, a.data(), &stride_a, b.data(), &stride_b, &kOne, c.data(), &m);
}

}  // namespace chladni::dense
