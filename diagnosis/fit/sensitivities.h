// The state of a fit, and the slopes of the responses in its coordinates.
#pragma once

#include <utility>
#include <vector>

#include "diagnosis/fit/fit.h"

namespace chladni::diagnosis {

/// The structure with its deviations (in units of their tolerances), then the causes in order.
[[nodiscard]] State state_of(const Problem& problem, const std::vector<Supposed>& causes,
                             const Eigen::VectorXd& eta);

/// The cause and the coordinate of a column.
struct Column {
  std::size_t cause = 0;
  Eigen::Index coordinate = 0;
  Parameter parameter;
};

/// The columns of all causes, cause by cause.
[[nodiscard]] std::vector<Column> columns_of(const Structure& structure,
                                             const std::vector<Supposed>& causes);

/// Factors of the steps to both sides that stay on the surface: 1 and 1, or one of them 0 at its
/// rim.
[[nodiscard]] std::pair<double, double> sides_on_surface(const Structure& structure,
                                                         const Supposed& cause,
                                                         const Column& column);

/// Weighted d value / d x of each coordinate: N × coordinates; causes first, then deviations.
[[nodiscard]] Eigen::MatrixXd sensitivities(const Problem& problem,
                                            const std::vector<Supposed>& causes,
                                            const Eigen::VectorXd& eta, const Solved& now);
/// Only the columns of the deviations, without the cost of the others: N × deviations.
[[nodiscard]] Eigen::MatrixXd sensitivities_of_deviations(const Problem& problem,
                                                          const std::vector<Supposed>& causes,
                                                          const Eigen::VectorXd& eta,
                                                          const Solved& now);

}  // namespace chladni::diagnosis
