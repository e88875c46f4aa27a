#include "simulators/twins.h"
#include "base/turn.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

namespace chladni::simulators {
namespace {

using Complex = std::complex<double>;

// A delay and a low-pass. Both have unit gain and a delay of `seconds` at 0 Hz.
Complex delayed(double omega, double seconds) { return std::polar(1.0, -omega * seconds); }
Complex passed(double omega, double seconds) { return 1.0 / Complex(1.0, omega * seconds); }

// Σ |G|² / σ² of the records that the effect acts on, per line.
Eigen::VectorXd weights(const HiddenCase& made, const HiddenEffect& effect) {
  const auto& measured = made.measured;
  const auto acts = [&](const std::vector<modal::MeasuredChannel>& channels, Eigen::Index c) {
    const auto& name = channels[static_cast<std::size_t>(c)].name;
    return std::ranges::find(effect.channels, name) != effect.channels.end();
  };
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(measured.frequency_hz.size());
  for (Eigen::Index k = 0; k < sum.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    for (Eigen::Index i = 0; i < made.exact[at].rows(); ++i) {
      for (Eigen::Index j = 0; j < made.exact[at].cols(); ++j) {
        const bool all = effect.channels.empty();
        if (!all && !acts(measured.outputs, i) && !acts(measured.inputs, j)) continue;
        sum(k) += std::norm(made.exact[at](i, j)) / measured.variance[at](i, j);
      }
    }
  }
  return sum;
}

// The distance of the truth from the case with moved instead of tilted channels.
double moved_apart(const HiddenCase& made) {
  double sum = 0.0;
  for (std::size_t k = 0; k < made.moved_instead.size(); ++k) {
    sum += ((made.exact[k] - made.moved_instead[k]).cwiseAbs2().array() /
            made.measured.variance[k].array())
               .sum();
  }
  return sum;
}

double apart(const HiddenCase& made, const HiddenEffect& effect) {
  if (effect.kind.ends_with("direction")) return moved_apart(made);
  const bool delay = effect.kind.ends_with("delay");
  if (!delay && !effect.kind.ends_with("low_pass")) return std::numeric_limits<double>::infinity();
  const double seconds =
      delay ? effect.size.at("delay") : 1.0 / (kTwoPi * effect.size.at("frequency"));
  const Eigen::VectorXd omega = kTwoPi * made.measured.frequency_hz;
  const Eigen::VectorXd weight = weights(made, effect);
  const auto distance = [&](double other) {
    double sum = 0.0;
    for (Eigen::Index k = 0; k < omega.size(); ++k) {
      const Complex ratio = delay ? passed(omega(k), other) / delayed(omega(k), seconds)
                                  : delayed(omega(k), other) / passed(omega(k), seconds);
      sum += std::norm(ratio - 1.0) * weight(k);
    }
    return sum;
  };
  double best = std::numeric_limits<double>::infinity();
  constexpr int kSteps = 2000;  // of 0.14 %
  for (int n = 0; n <= kSteps; ++n) {
    best = std::min(best, distance(0.25 * seconds * std::pow(16.0, n / double{kSteps})));
  }
  return best;
}

}  // namespace

double evidence_apart(const HiddenCase& made) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& effect : made.truth) least = std::min(least, apart(made, effect));
  return least;
}

}  // namespace chladni::simulators
