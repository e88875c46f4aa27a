// The discrete Riccati equation by doubling.
#include <fmt/format.h>

#include <Eigen/LU>

#include "base/error.h"
#include "dense/riccati.h"

namespace chladni::dense {
namespace {

Eigen::MatrixXd symmetric(const Eigen::MatrixXd& m) { return 0.5 * (m + m.transpose()); }

}  // namespace

Eigen::MatrixXd doubled_riccati(Eigen::MatrixXd a, Eigen::MatrixXd g, Eigen::MatrixXd h) {
  const auto n = a.rows();
  require(a.cols() == n && g.rows() == n && g.cols() == n && h.rows() == n && h.cols() == n,
          "Riccati equation: the sizes of A, G and H do not fit together");
  constexpr int kSteps = 60;      // 2⁶⁰ samples
  constexpr double kDone = 1e-8;  // convergence is quadratic: the next step changes 1e-16
  for (int step = 0; step < kSteps; ++step) {
    Eigen::MatrixXd both = g * h;
    both.diagonal().array() += 1.0;
    const Eigen::PartialPivLU<Eigen::MatrixXd> factor(both);
    const Eigen::MatrixXd ahead = factor.solve(a);
    const Eigen::MatrixXd more = a.transpose() * (h * ahead);
    g += a * factor.solve(g) * a.transpose();
    g = symmetric(g);
    h = symmetric(h + more);
    a = (a * ahead).eval();
    if (!h.allFinite()) break;
    if (more.norm() <= kDone * h.norm() && a.norm() <= 1.0) return h;
  }
  throw NumericalFailure(
      fmt::format("Riccati equation: doubling finds no limit for {} states: one does not decay and "
                  "is not seen, "
                  "or not moved",
                  n));
}

}  // namespace chladni::dense
