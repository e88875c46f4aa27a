// The only file that calls SLICOT. SLICOT is Fortran: columns are contiguous, and each text has a
// length after the last argument.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "base/error.h"
#include "dense/linear_systems.h"

extern "C" {
void mb05nd_(const int* n, const double* delta, const double* a, const int* lda, double* ex,
             const int* ldex, double* exint, const int* ldexin, const double* tol, int* iwork,
             double* dwork, const int* ldwork, int* info);
void ab09nd_(const char* dico, const char* job, const char* equil, const char* ordsel, const int* n,
             const int* m, const int* p, int* nr, const double* alpha, double* a, const int* lda,
             double* b, const int* ldb, double* c, const int* ldc, double* d, const int* ldd,
             int* ns, double* hsv, const double* tol1, const double* tol2, int* iwork,
             double* dwork, const int* ldwork, int* iwarn, int* info, std::size_t, std::size_t,
             std::size_t, std::size_t);
}

namespace chladni::dense {
namespace {

int whole(Eigen::Index n) { return static_cast<int>(n); }

// The length of a work array as Fortran counts it.
int work_size(Eigen::Index count, Eigen::Index states) {
  require(count <= std::numeric_limits<int>::max(),
          fmt::format("linear system: {} states are more than SLICOT can count in its work array",
                      states));
  return std::max(1, whole(count));
}

// Leading dimension: Fortran refuses 0.
int leading(const Eigen::MatrixXd& m) { return std::max(1, whole(m.rows())); }

void require_system(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, const Eigen::MatrixXd& c,
                    const Eigen::MatrixXd& d) {
  require(a.rows() == a.cols() && b.rows() == a.rows() && c.cols() == a.rows() &&
              d.rows() == c.rows() && d.cols() == b.cols(),
          "linear system: the sizes of A, B, C and D do not fit together");
  require(a.allFinite() && b.allFinite() && c.allFinite() && d.allFinite(),
          "linear system: an entry of A, B, C or D is not finite");
}

}  // namespace

ExponentialIntegral exponential_with_integral(const Eigen::MatrixXd& a, double t) {
  require(a.rows() == a.cols() && a.allFinite(),
          "matrix exponential: expected a square matrix of finite numbers");
  require(std::isfinite(t) && t >= 0.0,
          "matrix exponential: expected a time of 0 or more that is finite");
  const int size = work_size(2 * a.rows() * a.rows(), a.rows());
  const int n = whole(a.rows());
  ExponentialIntegral result{Eigen::MatrixXd::Identity(n, n), Eigen::MatrixXd::Zero(n, n)};
  if (n == 0 || t == 0.0) return result;
  const int lead = leading(a);
  const double accuracy = std::numeric_limits<double>::epsilon();
  std::vector<int> integers(static_cast<std::size_t>(n));
  std::vector<double> numbers(static_cast<std::size_t>(size));
  int info = 0;
  mb05nd_(&n, &t, a.data(), &lead, result.exponential.data(), &lead, result.integral.data(), &lead,
          &accuracy, integers.data(), numbers.data(), &size, &info);
  if (info != 0 || !result.exponential.allFinite() || !result.integral.allFinite()) {
    throw NumericalFailure(
        fmt::format("matrix exponential: e^{{At}} is too large for a number; A t is {:.3g}",
                    a.cwiseAbs().rowwise().sum().maxCoeff() * t));
  }
  return result;
}

BalancedReduction balanced_reduction(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                                     const Eigen::MatrixXd& c, const Eigen::MatrixXd& d,
                                     Eigen::Index order, double boundary) {
  require_system(a, b, c, d);
  require(boundary <= 0.0, "balanced reduction: the boundary of stability is above 0");
  require(
      order >= 0 && order <= a.rows(),
      fmt::format("balanced reduction: found an order of {}, expected 0 to {}", order, a.rows()));
  const auto states = a.rows();
  const auto widest = std::max({states, b.cols(), c.rows()});
  const int size =
      work_size(states * (2 * states + widest + 5) + states * (states + 1) / 2, states);
  BalancedReduction result{a, b, c, d, Eigen::VectorXd::Zero(a.rows()), 0};
  const int n = whole(a.rows());
  const int m = whole(b.cols());
  const int p = whole(c.rows());
  if (n == 0) return result;
  const int lead = leading(a);
  const int lead_c = leading(c);
  std::vector<int> integers(static_cast<std::size_t>(std::max(m, 2 * n)) + 1);
  std::vector<double> numbers(static_cast<std::size_t>(size));
  int found = whole(order);
  int stable = 0;
  int warning = 0;
  int info = 0;
  const double by_default = 0.0;
  // A fixed order, with the balancing-free square-root method, scaled first.
  ab09nd_("C", "N", "S", "F", &n, &m, &p, &found, &boundary, result.a.data(), &lead,
          result.b.data(), &lead, result.c.data(), &lead_c, result.d.data(), &lead_c, &stable,
          result.hankel.data(), &by_default, &by_default, integers.data(), numbers.data(), &size,
          &warning, &info, 1, 1, 1, 1);
  if (info != 0) {
    throw NumericalFailure(fmt::format("balanced reduction: {} (SLICOT {})",
                                       info == 3 ? "the Hankel singular values cannot be computed"
                                                 : "the stable part cannot be separated",
                                       info));
  }
  require(warning != 2,
          fmt::format("balanced reduction: found an order of {}, expected at least the {} states "
                      "that are not stable",
                      order, n - stable));
  result.a = result.a.topLeftCorner(found, found).eval();
  result.b = result.b.topRows(found).eval();
  result.c = result.c.leftCols(found).eval();
  result.hankel = result.hankel.head(stable).eval();
  result.unstable = n - stable;
  return result;
}

}  // namespace chladni::dense
