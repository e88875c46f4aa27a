#include "identification/poles/start_poles.h"

#include <algorithm>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "base/upper_median.h"
#include "identification/constants.h"
#include "identification/poles/mode_choice.h"
#include "identification/poles/vector_fit.h"

namespace chladni::identification {
namespace {

// Whether a maximum is twice the deepest point on the way to any higher one. Noise on the flank of
// a resonance is not.
bool is_prominent(const Eigen::ArrayXd& power, Eigen::Index top) {
  const auto falls = [&](Eigen::Index step) {
    double least = power(top);
    for (auto k = top + step; k >= 0 && k < power.size(); k += step) {
      if (power(k) > power(top)) return false;
      least = std::min(least, power(k));
      if (Constants::prominence * least < power(top)) return true;
    }
    return false;
  };
  return falls(-1) && falls(1);
}

// Visible resonances [Hz] as a first guess of the poles: maxima of Σ |ω² G|² that exceed the median
// around them by a factor of 3. Each response is divided by its mean.
std::vector<double> peaks(const FitData& data) {
  const auto lines = data.line_count();
  const Eigen::ArrayXd acceleration = data.frequency_hz.array().pow(4);
  Eigen::ArrayXd power = Eigen::ArrayXd::Zero(lines);
  for (Eigen::Index e = 0; e < data.response_count(); ++e) {
    const Eigen::ArrayXd response = data.value.col(e).cwiseAbs2().array() * acceleration;
    if (response.maxCoeff() > 0.0) power += response / response.mean();
  }
  const Eigen::Index around = std::max<Eigen::Index>(20, lines / 60);
  std::vector<double> list;
  std::vector<double> window;
  for (Eigen::Index k = Constants::peak_reach; k + Constants::peak_reach < lines; ++k) {
    if (power(k) <
        power.segment(k - Constants::peak_reach, 2 * Constants::peak_reach + 1).maxCoeff())
      continue;
    const auto first = std::max<Eigen::Index>(0, k - around);
    const auto last = std::min(lines, k + around);
    window.assign(power.data() + first, power.data() + last);
    if (power(k) <= Constants::peak_height * upper_median(window)) continue;
    if (data.noise_stated || is_prominent(power, k)) list.push_back(data.frequency_hz(k));
  }
  return list;
}

// Poles at the peaks with a usual structural damping; none if they are more than the order.
Eigen::VectorXcd poles_at(const std::vector<double>& peaks, Eigen::Index order) {
  const auto n = static_cast<Eigen::Index>(peaks.size());
  if (n > order) return {};
  return std::complex<double>(-Constants::peak_damping, 1.0) * 2.0 * std::numbers::pi *
         Eigen::Map<const Eigen::VectorXd>(peaks.data(), n).cast<std::complex<double>>();
}

}  // namespace

StartPoles start_poles(const FitData& data, const IdentificationOptions& options) {
  const bool rigid = options.rigid_count != 0;
  const auto room = std::max<Eigen::Index>(1, (data.line_count() - 4) / 3);
  const auto highest = std::min(options.most_modes + Constants::spare_order, room);
  const auto seen = peaks(data);
  const auto guess = options.modes > 0 ? options.modes : static_cast<Eigen::Index>(seen.size());
  // The spare order doubles the guess: a repeated pair is one peak, and so are close resonances.
  const auto spare = std::max(Constants::spare_order, guess);
  VectorFitOptions how{.order = std::min(guess + spare, highest), .rigid = rigid};
  how.enough = 1e-4;
  how.enough_value = Constants::settled_cost;
  if (data.noise_known) {  // so that what the fit leaves cannot look like a mode
    const double noise = expected_cost(data, 0).mean;
    how.enough_value =
        std::min(Constants::settled_cost, 0.5 * least_significance(data, noise) / noise);
  }
  how.start = poles_at(seen, how.order);
  std::optional<StartPoles> best;
  double least = std::numeric_limits<double>::infinity();
  for (; best == std::nullopt || how.order <= highest; how.order += 3 + how.order / 5) {
    tell(options.fit.progress, "finding poles");
    how.start = vector_fit(data, how);
    ResidueProblem problem(data, how.start, rigid, options.fit.damping);
    const double cost = problem.residues().cost;
    const bool better = cost < Constants::hardly_less * least;
    if (cost < least) {
      best.emplace(StartPoles{how.start, std::move(problem), how.order});
      least = cost;
    }
    const bool to_noise =
        data.noise_known && cost < Constants::noise_left * expected_cost(data, 0).mean;
    if (!better || to_noise) break;
  }
  return std::move(*best);
}

}  // namespace chladni::identification
