#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/interrupt.h"
#include "identification/constants.h"
#include "identification/identified.h"
#include "identification/poles/residue_problem.h"
#include "identification/poles/vector_fit.h"

namespace chladni::identification {
namespace {

struct Pole {
  StabilisationPoint point;
  Eigen::VectorXd shape;  // the pole's residues, normalised
};

std::vector<Pole> poles_of(const FitData& data, const Eigen::VectorXcd& poles, bool rigid) {
  const auto found = ResidueProblem(data, poles, rigid).residues();
  std::vector<Pole> kept;
  for (Eigen::Index i = 0; i < poles.size(); ++i) {
    Pole pole;
    pole.point.frequency_hz = std::abs(poles(i)) / (2.0 * std::numbers::pi);
    pole.point.damping_ratio = -poles(i).real() / std::abs(poles(i));
    pole.shape = found.of_pole[static_cast<std::size_t>(i)].reshaped().normalized();
    if (pole.point.damping_ratio < Constants::most_damping) kept.push_back(std::move(pole));
  }
  return kept;
}

void compare(const std::vector<Pole>& before, Pole& now) {
  const auto nearest =
      std::min_element(before.begin(), before.end(), [&](const Pole& a, const Pole& b) {
        return std::abs(a.point.frequency_hz - now.point.frequency_hz) <
               std::abs(b.point.frequency_hz - now.point.frequency_hz);
      });
  if (nearest == before.end()) return;
  const auto near = [](double a, double b, double part) { return std::abs(a - b) < part * b; };
  now.point.stable_frequency =
      near(nearest->point.frequency_hz, now.point.frequency_hz, Constants::stable_frequency);
  now.point.stable_damping =
      now.point.stable_frequency &&
      near(nearest->point.damping_ratio, now.point.damping_ratio, Constants::stable_damping);
  now.point.stable_shape = now.point.stable_frequency &&
                           std::pow(nearest->shape.dot(now.shape), 2) > Constants::stable_shape;
}

}  // namespace

std::vector<StabilisationPoint> stabilisation(const FitData& data, Eigen::Index highest_order,
                                              bool rigid, const Progress& progress) {
  std::vector<StabilisationPoint> points;
  std::vector<Pole> before;
  VectorFitOptions how{
      .order = 1, .rigid = rigid, .iterations = Constants::stabilisation_iterations};
  const auto room = (data.line_count() - 4) / 3;
  for (how.order = 2; how.order <= std::min(highest_order, room); how.order += 2) {
    throw_if_interrupted();
    tell(progress, "stabilisation",
         static_cast<double>(how.order) / static_cast<double>(highest_order));
    how.start = vector_fit(data, how);
    auto now = poles_of(data, how.start, rigid);
    for (auto& pole : now) {
      pole.point.order = how.order;
      compare(before, pole);
      points.push_back(pole.point);
    }
    before = std::move(now);
  }
  return points;
}

}  // namespace chladni::identification
