#include "placement/criteria.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"

namespace chladni::placement {

// A new criterion needs a file in placement/criteria/, its name here and its pointer in the table.
extern const Criterion weakest_mode;
extern const Criterion weakest_mode_rms;
extern const Criterion alpha_uncertainty;
extern const Criterion extended_rows;

namespace {

constinit const Criterion* const kCriteria[] = {
    &weakest_mode,
    &weakest_mode_rms,
    &alpha_uncertainty,
    &extended_rows,
};

double smallest_eigenvalue(const Eigen::MatrixXd& matrix) {
  if (matrix.rows() == 1) return matrix(0, 0);
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly)
      .eigenvalues()(0);
}

// Mean square error of an entry of the group, per row: noise and the effect of position errors.
Eigen::VectorXd blur(const PairView& view, const Eigen::MatrixXd& slopes,
                     const modal::ModeGroup& group) {
  const double noise = view.sensor_noise.segment(group.first, group.size).squaredNorm() +
                       view.actuator_noise.segment(group.first, group.size).squaredNorm();
  const Eigen::VectorXd moved = slopes.middleCols(group.first, group.size).rowwise().squaredNorm();
  const double variance = view.position_error * view.position_error;
  return ((noise + 2.0 * variance * moved.array()) / static_cast<double>(group.size)).matrix();
}

}  // namespace

std::span<const Criterion* const> criteria() { return kCriteria; }

const Criterion& criterion(std::string_view name) {
  const auto found = std::ranges::find(kCriteria, name, [](auto* c) { return c->name; });
  if (found != std::ranges::end(kCriteria)) return **found;
  std::string known;
  for (const auto* c : kCriteria) known.append(known.empty() ? "" : ", ").append(c->name);
  throw InvalidInput("no criterion \"" + std::string(name) + "\"; there are: " + known);
}

Eigen::MatrixXd visibility(const PairView& view, const Eigen::MatrixXd& weights) {
  const Eigen::Index pairs = view.present.rows();
  Eigen::MatrixXd seen(view.site_count(), view.group_count());
  for (Eigen::Index g = 0; g < seen.cols(); ++g) {
    const auto [first, size] = view.groups[static_cast<std::size_t>(g)];
    const auto columns = view.present.middleCols(first, size);
    const Eigen::MatrixXd there =
        columns.transpose() * weights.col(g).head(pairs).asDiagonal() * columns;
    for (Eigen::Index i = 0; i < seen.rows(); ++i) {
      const Eigen::VectorXd here = view.shapes.row(i).segment(first, size).transpose();
      const Eigen::MatrixXd both = there + weights(pairs + i, g) * here * here.transpose();
      const double square =
          pairs + 1 < size ? both.trace() / static_cast<double>(size) : smallest_eigenvalue(both);
      seen(i, g) = std::sqrt(std::max(square, 0.0));
    }
  }
  return seen;
}

Eigen::MatrixXd alpha_deviation(const PairView& view) {
  Eigen::MatrixXd weights(view.present.rows() + view.site_count(), view.group_count());
  for (Eigen::Index g = 0; g < weights.cols(); ++g) {
    const auto& group = view.groups[static_cast<std::size_t>(g)];
    weights.col(g) << blur(view, view.present_slopes, group).cwiseInverse(),
        blur(view, view.slopes, group).cwiseInverse();
  }
  return 0.5 * visibility(view, weights).cwiseMax(1e-9).cwiseInverse();
}

}  // namespace chladni::placement
