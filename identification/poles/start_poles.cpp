#include "identification/poles/start_poles.h"

#include <algorithm>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "identification/poles/mode_choice.h"
#include "identification/poles/vector_fit.h"

namespace chladni::identification {
namespace {

constexpr double kStartDamping = 0.005;  // of the poles at peaks
constexpr double kSettled = 0.05;        // relative change of the vector fit's cost at its end
constexpr double kHardlyLess = 0.7;      // cost of a higher order over that of a lower one
constexpr double kNoiseLeft = 1.3;       // cost over that of noise; the search stops below it
constexpr double kProminence = 2.0;      // ratio of a maximum to the valleys beside it
constexpr Eigen::Index kSpareOrder = 5;
constexpr int kPeakReach = 3;  // a peak is the maximum of so many lines on each side

// Whether a maximum is twice the deepest point on the way to any higher one. Noise on the flank of
// a resonance is not.
bool is_prominent(const Eigen::ArrayXd& all, Eigen::Index top) {
  const auto falls = [&](Eigen::Index step) {
    double least = all(top);
    for (auto k = top + step; k >= 0 && k < all.size(); k += step) {
      if (all(k) > all(top)) return false;
      least = std::min(least, all(k));
      if (kProminence * least < all(top)) return true;
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
  Eigen::ArrayXd all = Eigen::ArrayXd::Zero(lines);
  for (Eigen::Index e = 0; e < data.response_count(); ++e) {
    const Eigen::ArrayXd one = data.value.col(e).cwiseAbs2().array() * acceleration;
    if (one.maxCoeff() > 0.0) all += one / one.mean();
  }
  const Eigen::Index around = std::max<Eigen::Index>(20, lines / 60);
  std::vector<double> list;
  std::vector<double> window;
  for (Eigen::Index k = kPeakReach; k + kPeakReach < lines; ++k) {
    if (all(k) < all.segment(k - kPeakReach, 2 * kPeakReach + 1).maxCoeff()) continue;
    const auto first = std::max<Eigen::Index>(0, k - around);
    const auto last = std::min(lines, k + around);
    window.assign(all.data() + first, all.data() + last);
    std::nth_element(window.begin(), window.begin() + static_cast<long>(window.size() / 2),
                     window.end());
    if (all(k) <= 3.0 * window[window.size() / 2]) continue;
    if (data.noise_stated || is_prominent(all, k)) list.push_back(data.frequency_hz(k));
  }
  return list;
}

// Poles at the peaks with a usual structural damping; none if they are more than the order.
Eigen::VectorXcd poles_at(const std::vector<double>& peaks, Eigen::Index order) {
  const auto n = static_cast<Eigen::Index>(peaks.size());
  if (n > order) return {};
  return std::complex<double>(-kStartDamping, 1.0) * 2.0 * std::numbers::pi *
         Eigen::Map<const Eigen::VectorXd>(peaks.data(), n).cast<std::complex<double>>();
}

}  // namespace

StartPoles start_poles(const FitData& data, const IdentificationOptions& options) {
  const bool rigid = options.rigid_count != 0;
  const auto room = std::max<Eigen::Index>(1, (data.line_count() - 4) / 3);
  const auto highest = std::min(options.most_modes + kSpareOrder, room);
  const auto seen = peaks(data);
  const auto guess = options.modes > 0 ? options.modes : static_cast<Eigen::Index>(seen.size());
  // The spare order doubles the guess: a repeated pair is one peak, and so are close resonances.
  const auto spare = std::max(kSpareOrder, guess);
  VectorFitOptions how{.order = std::min(guess + spare, highest), .rigid = rigid};
  how.enough = 1e-4;
  how.enough_value = kSettled;
  if (data.noise_known) {  // so that what the fit leaves cannot look like a mode
    const double noise = expected_cost(data, 0).mean;
    how.enough_value = std::min(kSettled, 0.5 * least_significance(data, noise) / noise);
  }
  how.start = poles_at(seen, how.order);
  std::optional<StartPoles> best;
  double least = std::numeric_limits<double>::infinity();
  for (; best == std::nullopt || how.order <= highest; how.order += 3 + how.order / 5) {
    tell(options.fit.progress, "finding poles");
    how.start = vector_fit(data, how);
    ResidueProblem problem(data, how.start, rigid, options.fit.damping);
    const double cost = problem.residues().cost;
    const bool better = cost < kHardlyLess * least;
    if (cost < least) {
      best.emplace(StartPoles{how.start, std::move(problem), how.order});
      least = cost;
    }
    const bool to_noise = data.noise_known && cost < kNoiseLeft * expected_cost(data, 0).mean;
    if (!better || to_noise) break;
  }
  return std::move(*best);
}

}  // namespace chladni::identification
