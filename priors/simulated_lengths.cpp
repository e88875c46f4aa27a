#include "priors/simulated_lengths.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "priors/constants.h"
#include "priors/methods/euclidean_field.h"

namespace chladni::priors {
std::vector<Eigen::Index> spread_points(const Points& points, Eigen::Index count) {
  const Eigen::RowVector3d middle = points.colwise().mean();
  std::vector<Eigen::Index> chosen;
  Eigen::VectorXd distance = (points.rowwise() - middle).rowwise().squaredNorm();
  while (static_cast<Eigen::Index>(chosen.size()) < std::min(count, points.rows())) {
    Eigen::Index next = 0;
    if (distance.maxCoeff(&next) <= 0.0) break;  // all other points are copies
    chosen.push_back(next);
    const Eigen::VectorXd from = (points.rowwise() - points.row(next)).rowwise().squaredNorm();
    if (chosen.size() == 1) distance = from;
    distance = distance.cwiseMin(from);
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

SimulatedLengths simulated_lengths(const std::string& method, const Kernel& kernel,
                                   const Simulation& simulation, double most_hz) {
  (void)common_direction(method, simulation.surface);
  const auto rows = spread_points(simulation.surface.position, Constants::length_samples);
  const Places sample = part(simulation.surface, rows);
  const Eigen::VectorXd size = sample.shapes.colwise().norm();
  SimulatedLengths lengths;
  for (Eigen::Index j = simulation.rigid_count(); j < simulation.mode_count(); ++j) {
    const bool in_band = simulation.frequency_hz(j) <= most_hz || lengths.columns.empty();
    if (in_band && size(j) > Constants::still * size.maxCoeff()) lengths.columns.push_back(j);
  }
  require(!lengths.columns.empty(),
          method +
              ": the simulation has no flexible mode that moves the surface along the "
              "measured direction; nothing to learn a length scale from");
  lengths.frequency_hz = simulation.frequency_hz(lengths.columns);
  Learning how;
  how.length_range = length_range(sample.position);
  lengths.longest = how.length_range.second;
  lengths.learned =
      learned(kernel, sample.position, sample.shapes(Eigen::all, lengths.columns), how);
  return lengths;
}

int shortest(const SimulatedLengths& lengths) {
  const auto found = std::min_element(
      lengths.learned.begin(), lengths.learned.end(),
      [](const auto& a, const auto& b) { return a.parameters(0) < b.parameters(0); });
  return static_cast<int>(found - lengths.learned.begin());
}

int matching(const SimulatedLengths& lengths, const MeasuredShapes& measured, Eigen::Index mode) {
  const double frequency = measured.frequency_hz(mode);
  if (frequency < Constants::rigid_frequency * lengths.frequency_hz(0)) return -1;
  const Eigen::VectorXd values = measured.values.col(mode);
  const Eigen::ArrayXd ratio = lengths.frequency_hz.array() / frequency;
  const bool any = (ratio >= 0.5 && ratio <= 2.0).any();
  int best = -1;
  double highest = -1.0;
  for (Eigen::Index k = 0; k < ratio.size(); ++k) {
    if (any && (ratio(k) < 0.5 || ratio(k) > 2.0)) continue;
    const Eigen::VectorXd shape =
        measured.places.shapes.col(lengths.columns[static_cast<std::size_t>(k)]);
    const double product = values.dot(shape);
    const double alike = product * product / std::max(shape.squaredNorm(), 1e-300);
    if (alike <= highest) continue;
    highest = alike;
    best = static_cast<int>(k);
  }
  return best;
}

}  // namespace chladni::priors
