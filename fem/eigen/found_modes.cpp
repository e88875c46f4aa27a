#include "fem/eigen/found_modes.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "base/turn.h"
#include "fem/eigen/canonical.h"
#include "fem/eigen/mode_checks.h"
#include "fem/eigen/residual.h"
#include "fem/eigen/symmetric_product.h"
#include "modal/repeated.h"

namespace chladni::fem {

double inverted_shift(const System& system, double shift_hz) {
  const double hz = shift_hz > 0.0 ? shift_hz : 2.0 * system.frequency_scale_hz;
  if (hz > 0.0) return std::pow(kTwoPi * hz, 2);
  return 1e-5 * system.stiffness.diagonal().sum() / system.mass.diagonal().sum();
}

Eigen::Index uncut(const Eigen::VectorXd& lambda, Eigen::Index count) {
  while (count < lambda.size() &&
         lambda(count) - lambda(count - 1) < 2.0 * modal::kSplitByMesh * lambda(count)) {
    ++count;
  }
  return count;
}

void settle(const System& system, Found& found) {
  const Eigen::VectorXd before = found.lambda;
  for (const auto& cluster : orient(system, found.lambda, found.shapes, 0)) {
    auto part = found.residual.segment(cluster.first, cluster.size);
    const double turned = found.lambda(cluster.first);
    const double off =
        (before.segment(cluster.first, cluster.size).array() / turned - 1.0).abs().maxCoeff();
    part.setConstant(part.norm() + off);
  }
}

Eigen::MatrixXd rigid_motions(const System& system) {
  return system.rigid.cols() > 0 ? system.rigid : Eigen::MatrixXd(system.mass.rows(), 0);
}

Eigen::MatrixXd beside(const Eigen::MatrixXd& left, const Eigen::MatrixXd& right) {
  Eigen::MatrixXd both(left.rows(), left.cols() + right.cols());
  both << left, right;
  return both;
}

ModesResult assembled(const System& system, const Found& found, Eigen::Index kept,
                      ModesSummary summary) {
  const auto rigid = system.rigid.cols();
  ModesResult result;
  result.summary = std::move(summary);
  Eigen::VectorXd lambda = Eigen::VectorXd::Zero(rigid + kept);
  lambda.tail(kept) = found.lambda.head(kept);
  result.modes.rigid_count = rigid;
  result.modes.shapes = beside(rigid_motions(system), found.shapes.leftCols(kept));
  result.summary.clusters = clusters(lambda, rigid);
  result.modes.frequency_hz = lambda.cwiseMax(0.0).cwiseSqrt() / kTwoPi;
  result.modes.damping_ratio = Eigen::VectorXd::Zero(lambda.size());
  result.summary.residual.resize(rigid + kept);
  result.summary.residual << rigid_residuals(system, result.modes.shapes.leftCols(rigid)),
      found.residual.head(kept);
  result.summary.warnings = judged(system, found.lambda.head(kept), found.residual.head(kept));
  const Eigen::MatrixXd gram =
      result.modes.shapes.transpose() * (SymmetricProduct(system.mass) * result.modes.shapes);
  result.summary.orthogonality =
      (gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff();
  if (!(result.summary.orthogonality < 1e-8)) {
    throw NumericalFailure(
        fmt::format("modes: the shapes lost their orthogonality: max |ΦᵀMΦ − I| = {:.2g}, expected "
                    "less than 1e-8",
                    result.summary.orthogonality));
  }
  return result;
}

}  // namespace chladni::fem
