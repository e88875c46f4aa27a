#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/interrupt.h"
#include "identification/identified.h"
#include "identification/poles/residue_problem.h"
#include "identification/poles/vector_fit.h"

namespace chladni::identification {
namespace {

constexpr double kFrequency = 1e-3, kDamping = 0.05, kShape = 0.98;
constexpr double kMostDamping = 0.4;
constexpr int kIterations = 6;  // for each order, from the poles of the order below

struct Pole {
  StabilisationPoint point;
  Eigen::VectorXd shape;  // the pole's residues, normalised
};

std::vector<Pole> poles_of(const FitData& data, const Eigen::VectorXcd& poles, bool rigid) {
  const auto found = ResidueProblem(data, poles, rigid).residues();
  std::vector<Pole> all;
  for (Eigen::Index i = 0; i < poles.size(); ++i) {
    Pole one;
    one.point.frequency_hz = std::abs(poles(i)) / (2.0 * std::numbers::pi);
    one.point.damping_ratio = -poles(i).real() / std::abs(poles(i));
    one.shape = found.of_pole[static_cast<std::size_t>(i)].reshaped().normalized();
    if (one.point.damping_ratio < kMostDamping) all.push_back(std::move(one));
  }
  return all;
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
      near(nearest->point.frequency_hz, now.point.frequency_hz, kFrequency);
  now.point.stable_damping = now.point.stable_frequency &&
                             near(nearest->point.damping_ratio, now.point.damping_ratio, kDamping);
  now.point.stable_shape =
      now.point.stable_frequency && std::pow(nearest->shape.dot(now.shape), 2) > kShape;
}

}  // namespace

std::vector<StabilisationPoint> stabilisation(const FitData& data, Eigen::Index highest_order,
                                              bool rigid, const Progress& progress) {
  std::vector<StabilisationPoint> all;
  std::vector<Pole> before;
  VectorFitOptions how{.order = 1, .rigid = rigid, .iterations = kIterations};
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
      all.push_back(pole.point);
    }
    before = std::move(now);
  }
  return all;
}

}  // namespace chladni::identification
