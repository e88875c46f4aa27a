// The only file that calls SLICOT. SLICOT is Fortran: columns are contiguous, and each text has a
// length after the last argument.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "base/error.h"
#include "dense/linear_systems.h"
#include "dense/riccati.h"

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
void sb02od_(const char* dico, const char* jobb, const char* fact, const char* uplo,
             const char* jobl, const char* sort, const int* n, const int* m, const int* p,
             const double* a, const int* lda, const double* b, const int* ldb, const double* q,
             const int* ldq, const double* r, const int* ldr, const double* l, const int* ldl,
             double* rcond, double* x, const int* ldx, double* alfar, double* alfai, double* beta,
             double* s, const int* lds, double* t, const int* ldt, double* u, const int* ldu,
             const double* tol, int* iwork, double* dwork, const int* ldwork, int* bwork, int* info,
             std::size_t, std::size_t, std::size_t, std::size_t, std::size_t, std::size_t);
void sb03md_(const char* dico, const char* job, const char* fact, const char* trana, const int* n,
             double* a, const int* lda, double* u, const int* ldu, double* c, const int* ldc,
             double* scale, double* sep, double* ferr, double* wr, double* wi, int* iwork,
             double* dwork, const int* ldwork, int* info, std::size_t, std::size_t, std::size_t,
             std::size_t);
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

void require_noise(const NoisySystem& system) {
  const auto n = system.a.rows();
  const auto p = system.c.rows();
  require(system.a.cols() == n && system.c.cols() == n && system.q.rows() == n &&
              system.q.cols() == n && system.r.rows() == p && system.r.cols() == p &&
              system.s.rows() == n && system.s.cols() == p,
          "noisy system: the sizes of A, C, Q, R and S do not fit together");
  require(system.a.allFinite() && system.c.allFinite() && system.q.allFinite() &&
              system.r.allFinite() && system.s.allFinite(),
          "noisy system: an entry of A, C, Q, R or S is not finite");
  require(p > 0 && Eigen::LLT<Eigen::MatrixXd>(system.r).info() == Eigen::Success,
          "noisy system: the covariance R of the measurements is not positive definite");
}

// One step of the difference equation whose steady state is wanted.
Eigen::MatrixXd next_covariance(const NoisySystem& system, const Eigen::MatrixXd& p) {
  const Eigen::MatrixXd seen = system.c * p;
  const Eigen::LLT<Eigen::MatrixXd> innovation(
      Eigen::MatrixXd(seen * system.c.transpose() + system.r));
  const Eigen::MatrixXd cross = seen * system.a.transpose() + system.s.transpose();
  const Eigen::MatrixXd next =
      system.a * p * system.a.transpose() + system.q - cross.transpose() * innovation.solve(cross);
  return 0.5 * (next + next.transpose());
}

// Deviations of the states; 1 of a state that no noise reaches.
Eigen::VectorXd scales(const Eigen::MatrixXd& p) {
  return p.diagonal().unaryExpr(
      [](double variance) { return variance > 0.0 ? std::sqrt(variance) : 1.0; });
}

// The same system in states x / scale, with measurements whose noise has a deviation of 1.
NoisySystem scaled(const NoisySystem& system, const Eigen::VectorXd& scale) {
  const Eigen::VectorXd inverse = scale.cwiseInverse();
  const Eigen::VectorXd quiet = scales(system.r).cwiseInverse();
  return {inverse.asDiagonal() * system.a * scale.asDiagonal(),
          quiet.asDiagonal() * system.c * scale.asDiagonal(),
          inverse.asDiagonal() * system.q * inverse.asDiagonal(),
          quiet.asDiagonal() * system.r * quiet.asDiagonal(),
          inverse.asDiagonal() * system.s * quiet.asDiagonal()};
}

Eigen::MatrixXd solved_riccati(const NoisySystem& system) {
  const int n = whole(system.a.rows());
  const int p = whole(system.c.rows());
  const int twice = 2 * n;
  const int all = twice + p;
  // SLICOT has the equation of the controller: A and C are transposed.
  const Eigen::MatrixXd a = system.a.transpose();
  const Eigen::MatrixXd b = system.c.transpose();
  Eigen::MatrixXd x(n, n);
  Eigen::MatrixXd s(all, all);
  Eigen::MatrixXd t(all, twice);
  Eigen::MatrixXd u(twice, twice);
  Eigen::VectorXd alpha(twice);
  Eigen::VectorXd imaginary(twice);
  Eigen::VectorXd beta(twice);
  const int size = work_size(std::max({14 * n + 23, 32 * n, all, 3 * p}), n);
  std::vector<double> numbers(static_cast<std::size_t>(size));
  std::vector<int> integers(static_cast<std::size_t>(std::max(p, twice)));
  std::vector<int> truths(static_cast<std::size_t>(twice));
  double condition = 0.0;
  const double by_default = 0.0;
  int info = 0;
  sb02od_("D", "B", "N", "U", "N", "S", &n, &p, &p, a.data(), &n, b.data(), &n, system.q.data(), &n,
          system.r.data(), &p, system.s.data(), &n, &condition, x.data(), &n, alpha.data(),
          imaginary.data(), beta.data(), s.data(), &all, t.data(), &all, u.data(), &twice,
          &by_default, integers.data(), numbers.data(), &size, truths.data(), &info, 1, 1, 1, 1, 1,
          1);
  if (info != 0 || !x.allFinite()) {
    throw NumericalFailure(
        fmt::format("Riccati equation: there is no stabilising solution (SLICOT {}): a state that "
                    "does not decay is not seen, or not disturbed",
                    info));
  }
  return 0.5 * (x + x.transpose());
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

Eigen::MatrixXd prediction_covariance(const NoisySystem& system) {
  require_noise(system);
  if (system.a.rows() == 0) return {};
  constexpr int kSteps = 20;  // enough for the size of each state's deviation
  Eigen::MatrixXd p = system.q;
  for (int step = 0; step < kSteps; ++step) p = next_covariance(system, p);
  for (int pass = 0; pass < 2; ++pass) {
    const Eigen::VectorXd scale = scales(p);
    p = scale.asDiagonal() * solved_riccati(scaled(system, scale)) * scale.asDiagonal();
  }
  const Eigen::VectorXd inverse = scales(p).cwiseInverse();
  const Eigen::MatrixXd wrong =
      inverse.asDiagonal() * (next_covariance(system, p) - p) * inverse.asDiagonal();
  const double off = wrong.cwiseAbs().maxCoeff();
  if (!(off <= 1e-6)) {
    throw NumericalFailure(fmt::format(
        "Riccati equation: the solution is off by {:.2g} of a variance, expected 1e-6 or less",
        off));
  }
  return p;
}

Eigen::MatrixXd stationary_covariance(const Eigen::MatrixXd& a, const Eigen::MatrixXd& q) {
  require(a.rows() == a.cols() && q.rows() == a.rows() && q.cols() == a.rows() && a.allFinite() &&
              q.allFinite(),
          "stationary covariance: expected square matrices of one size, of finite numbers");
  const int n = whole(a.rows());
  if (n == 0) return {};
  Eigen::MatrixXd schur = a;
  Eigen::MatrixXd x = -q;
  Eigen::MatrixXd u(n, n);
  Eigen::VectorXd real = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd imaginary = Eigen::VectorXd::Zero(n);
  const int size = work_size(2 * a.rows() * a.rows() + 3 * a.rows(), a.rows());
  std::vector<double> numbers(static_cast<std::size_t>(size));
  std::vector<int> integers(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
  double scale = 1.0;
  double separation = 0.0;
  double error = 0.0;
  int info = 0;
  sb03md_("D", "X", "N", "T", &n, schur.data(), &n, u.data(), &n, x.data(), &n, &scale, &separation,
          &error, real.data(), imaginary.data(), integers.data(), numbers.data(), &size, &info, 1,
          1, 1, 1);
  const double largest = (real.cwiseAbs2() + imaginary.cwiseAbs2()).cwiseSqrt().maxCoeff();
  if (info != 0 || scale != 1.0 || largest >= 1.0 || !x.allFinite()) {
    throw NumericalFailure(
        fmt::format("stationary covariance: the system does not decay (largest eigenvalue {:.10g}, "
                    "SLICOT {})",
                    largest, info));
  }
  return 0.5 * (x + x.transpose());
}

}  // namespace chladni::dense
