#include "placement/layout.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "placement/constants.h"

namespace chladni::placement {

// A new criterion needs a definition in placement/layout_criteria/, its name here and its
// pointer in the table.
extern const LayoutCriterion observed_points, observability, controllability, response, determinant,
    a_optimality, smallest_singular_value, condition, auto_mac, effective_independence,
    kinetic_energy, pair_alpha, interpolation_error, interpolation_worst_mode,
    interpolation_worst_place, frf_at_interest, observer_error, loop_cost;

namespace {

constinit const LayoutCriterion* const kLayoutCriteria[] = {
    &observed_points,
    &observability,
    &controllability,
    &response,
    &determinant,
    &a_optimality,
    &smallest_singular_value,
    &condition,
    &auto_mac,
    &effective_independence,
    &kinetic_energy,
    &pair_alpha,
    &interpolation_error,
    &interpolation_worst_mode,
    &interpolation_worst_place,
    &frf_at_interest,
    &observer_error,
    &loop_cost,
};

std::vector<Eigen::Index> lone_actuators(const LayoutView& view) {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index a = 0; a < view.actuators.rows(); ++a) {
    const bool paired = std::any_of(view.pairs.begin(), view.pairs.end(),
                                    [&](const auto& pair) { return pair.second == a; });
    if (!paired) rows.push_back(a);
  }
  return rows;
}

}  // namespace

std::span<const LayoutCriterion* const> layout_criteria() { return kLayoutCriteria; }

Eigen::MatrixXd observed(const LayoutView& view) {
  const auto lone = lone_actuators(view);
  Eigen::MatrixXd all(view.sensors.rows() + static_cast<Eigen::Index>(lone.size()),
                      view.rms.size());
  all << view.sensors, view.actuators(lone, Eigen::all);
  return all * view.rms.cwiseInverse().asDiagonal();
}

Samples samples(const LayoutView& view) {
  const auto lone = lone_actuators(view);
  const Eigen::Index sensors = view.sensors_all.rows();
  const auto count = sensors + static_cast<Eigen::Index>(lone.size());
  Samples all{Eigen::MatrixXd(count, view.surface_all.cols()),
              Eigen::MatrixXd(count, view.rms.size())};
  all.rows << view.sensors_all, view.actuators_all(lone, Eigen::all);
  const Eigen::RowVectorXd sensor = view.sensor_noise.cwiseQuotient(view.rms).transpose();
  const Eigen::RowVectorXd actuator = view.actuator_noise.cwiseQuotient(view.rms).transpose();
  for (Eigen::Index k = 0; k < count; ++k) all.noise.row(k) = k < sensors ? sensor : actuator;
  for (const auto& [s, a] : view.pairs) {
    all.noise.row(s) = (sensor.cwiseAbs2().cwiseInverse() + actuator.cwiseAbs2().cwiseInverse())
                           .cwiseInverse()
                           .cwiseSqrt();
  }
  return all;
}

Eigen::VectorXd sight(const LayoutView& view) {
  const Eigen::MatrixXd seen = observed(view);
  Eigen::VectorXd least = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(view.groups.size()));
  if (seen.rows() == 0) return least;
  for (Eigen::Index g = 0; g < least.size(); ++g) {
    const auto [first, size] = view.groups[static_cast<std::size_t>(g)];
    const Eigen::MatrixXd block = seen.middleCols(first, size);
    const Eigen::MatrixXd gram = block.transpose() * block;
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(gram, Eigen::EigenvaluesOnly).eigenvalues();
    least(g) = std::sqrt(std::max(values(0), 0.0));
  }
  return least;
}

std::vector<std::pair<Eigen::Index, Eigen::Index>> collocated(const Lines& sensors,
                                                              const Lines& actuators, double beside,
                                                              double along) {
  struct Near {
    double apart = 0.0;
    Eigen::Index sensor = 0, actuator = 0;
  };
  std::vector<Near> all;
  for (Eigen::Index s = 0; s < sensors.position.rows(); ++s) {
    const Eigen::RowVector3d direction = sensors.direction.row(s);
    for (Eigen::Index a = 0; a < actuators.position.rows(); ++a) {
      const Eigen::RowVector3d apart = sensors.position.row(s) - actuators.position.row(a);
      const double ahead = std::abs(apart.dot(direction));
      const double across = (apart - apart.dot(direction) * direction).norm();
      const bool parallel =
          std::abs(direction.dot(actuators.direction.row(a))) > Constants::parallel;
      if (parallel && across <= beside && ahead <= along) all.push_back({apart.norm(), s, a});
    }
  }
  std::ranges::stable_sort(all, {}, &Near::apart);
  std::vector<std::pair<Eigen::Index, Eigen::Index>> pairs;
  for (const auto& near : all) {
    const bool is_taken = std::ranges::any_of(pairs, [&](const auto& pair) {
      return pair.first == near.sensor || pair.second == near.actuator;
    });
    if (!is_taken) pairs.emplace_back(near.sensor, near.actuator);
  }
  std::ranges::sort(pairs);
  return pairs;
}

}  // namespace chladni::placement
