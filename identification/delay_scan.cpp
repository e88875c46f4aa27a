#include "identification/delay_scan.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "identification/residue_problem.h"

namespace chladni::identification {
namespace {

constexpr double kLowest = -0.5, kHighest = 2.5, kStep = 0.04;  // periods of the highest line

}  // namespace

FitData undelayed(const FitData& data, double delay_s) {
  FitData result = data;
  const Eigen::VectorXd angle = 2.0 * std::numbers::pi * delay_s * data.frequency_hz;
  for (Eigen::Index k = 0; k < data.line_count(); ++k) {
    result.value.row(k) *= std::polar(1.0, angle(k));
  }
  return result;
}

double scanned_delay(const FitData& data, const Eigen::VectorXcd& poles, bool rigid) {
  const double period = 1.0 / data.frequency_hz(data.line_count() - 1);
  const auto cost = [&](double periods) {
    return ResidueProblem(undelayed(data, periods * period), poles, rigid).residues().cost;
  };
  double best = 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (double at = kLowest; at <= kHighest; at += kStep) {
    const double here = cost(at);
    if (here < least) {
      least = here;
      best = at;
    }
  }
  // The top of the parabola through the least one and its neighbours.
  const double before = cost(best - kStep);
  const double after = cost(best + kStep);
  const double curvature = before - 2.0 * least + after;
  if (curvature > 0.0) best += 0.5 * kStep * (before - after) / curvature;
  return best * period;
}

}  // namespace chladni::identification
