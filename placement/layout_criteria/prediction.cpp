// Predictions that a layout allows: the pair's gain, the shapes between the points, an FRF.
#include <cmath>
#include <numbers>

#include "placement/constants.h"
#include "placement/criteria.h"
#include "placement/layout.h"
#include "placement/layout_criteria/undefined.h"

namespace chladni::placement {
namespace {

double alpha_percent(const LayoutView& view) {
  if (view.pairs.empty()) return kUndefined;
  PairView pairs;
  pairs.groups = view.groups;
  const auto count = static_cast<Eigen::Index>(view.pairs.size());
  Eigen::MatrixXd shapes(count, view.sensors.cols());
  for (Eigen::Index p = 0; p < count; ++p) {
    shapes.row(p) = view.sensors.row(view.pairs[static_cast<std::size_t>(p)].first);
  }
  pairs.shapes = shapes.bottomRows(1);
  pairs.present = shapes.topRows(count - 1);
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(count, shapes.cols());
  if (view.position_error > 0.0) slopes = view.pair_slopes;
  pairs.slopes = slopes.bottomRows(1);
  pairs.present_slopes = slopes.topRows(count - 1);
  pairs.position_error = view.position_error;
  pairs.sensor_noise = view.sensor_noise;
  pairs.actuator_noise = view.actuator_noise;
  return 100.0 * alpha_deviation(pairs).maxCoeff();
}

Eigen::VectorXd errors(const LayoutView& view) {
  const auto seen = samples(view);
  if (seen.rows.rows() == 0) return {};
  return expected_error(view.prior, seen.rows, seen.noise).per_mode;
}

double mean_error(const LayoutView& view) {
  const auto error = errors(view);
  return error.size() == 0 ? kUndefined : error.mean();
}

double worst_mode(const LayoutView& view) {
  const auto error = errors(view);
  if (error.size() == 0) return kUndefined;
  double worst = 0.0;
  for (const auto& group : view.groups) {
    worst = std::max(worst, error.segment(group.first, group.size).mean());
  }
  return worst;
}

// Root mean square deviation over the wanted modes, at the place with the largest one.
double worst_place(const LayoutView& view) {
  const auto seen = samples(view);
  if (seen.rows.rows() == 0) return kUndefined;
  const Eigen::MatrixXd deviation =
      expected_deviation(view.prior, seen.rows, seen.noise, view.surface_all);
  return 100.0 * std::sqrt(deviation.cwiseAbs2().rowwise().mean().maxCoeff());
}

// Missed part of the modes' peak energy, from all actuators to the points of interest.
double frf_percent(const LayoutView& view) {
  const auto seen = samples(view);
  if (view.interest_all.rows() == 0 || view.actuators.rows() == 0 || seen.rows.rows() == 0) {
    return kUndefined;
  }
  const Eigen::MatrixXd deviation =
      expected_deviation(view.prior, seen.rows, seen.noise, view.interest_all);
  double missed = 0.0;
  double present = 0.0;
  for (const auto& group : view.groups) {
    const double omega = 2.0 * std::numbers::pi * view.frequency_hz(group.first);
    const double damping = std::max(view.damping_ratio(group.first), Constants::least_damping);
    const auto columns = [&](const Eigen::MatrixXd& m) {
      return m.middleCols(group.first, group.size);
    };
    const double drive = columns(view.actuators).squaredNorm() / static_cast<double>(group.size) /
                         (4.0 * damping * std::pow(omega, 3));
    const double scale = std::pow(view.rms(group.first), 2);
    missed += drive * scale * columns(deviation).squaredNorm();
    present += drive * columns(view.interest).squaredNorm();
  }
  return present > 0.0 ? 100.0 * std::sqrt(missed / present) : kUndefined;
}

}  // namespace

extern const LayoutCriterion pair_alpha, interpolation_error, interpolation_worst_mode,
    interpolation_worst_place, frf_at_interest;
constinit const LayoutCriterion pair_alpha{
    "pair_alpha",
    "how well the collocated pairs will let alpha be known: standard deviation of the worst mode",
    "Cramer-Rao bound of (5.5)",
    "%",
    false,
    alpha_percent};
constinit const LayoutCriterion interpolation_error{
    "interpolation_error",
    "expected squared error of the interpolated shapes, over the shape's own square, mean of the "
    "modes (I-optimality under the dynamic-residual prior)",
    "thesis 5.4; Balmes 1999",
    "1",
    false,
    mean_error};
constinit const LayoutCriterion interpolation_worst_mode{"interpolation_worst_mode",
                                                         "the same for the worst mode",
                                                         "thesis 5.4; Balmes 1999",
                                                         "1",
                                                         false,
                                                         worst_mode};
constinit const LayoutCriterion interpolation_worst_place{
    "interpolation_worst_place",
    "expected error at the worst place of the surface, over the shapes' root mean square",
    "thesis 5.4; Balmes 1999",
    "%",
    false,
    worst_place};
constinit const LayoutCriterion frf_at_interest{
    "frf_at_interest",
    "expected error of the FRFs from all actuators to the points of interest, over their peaks",
    "thesis 5.4; Balmes 1999",
    "%",
    false,
    frf_percent};

}  // namespace chladni::placement
