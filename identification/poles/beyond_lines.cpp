#include "identification/poles/beyond_lines.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "base/turn.h"
#include "identification/constants.h"
#include "identification/poles/residue_problem.h"

namespace chladni::identification {
namespace {

// Whether a pole lies so far beyond the lines that none sees its resonance.
bool is_far(const FitData& data, const std::complex<double>& pole) {
  const double own = std::abs(pole) / kTwoPi;
  const auto& lines = data.frequency_hz;
  const double lowest = lines(0) > 0.0 || lines.size() < 2 ? lines(0) : lines(1);
  return own * Constants::far_beyond < lowest ||
         own > Constants::far_beyond * lines(lines.size() - 1);
}

}  // namespace

bool is_beyond_lines(const FitData& data, double frequency_hz) {
  return frequency_hz < Constants::below_band * data.frequency_hz(0) ||
         frequency_hz > Constants::above_band * data.frequency_hz(data.line_count() - 1);
}

bool has_no_resonance(const FitData& data, const std::complex<double>& pole) {
  return is_far(data, pole) || -pole.real() > Constants::no_peak * std::abs(pole);
}

bool has_mode_without_resonance(const FitData& data, const ModalFit& fit) {
  const auto poles = start_at(fit.model).pole;
  return std::any_of(poles.begin(), poles.end(),
                     [&](const auto& pole) { return has_no_resonance(data, pole); });
}

void drop_modes_without_resonance(const FitData& data, const FitOptions& options, ModalFit& fit) {
  constexpr int kRounds = 3;  // a fit without one mode may bring another one there
  for (int round = 0; round < kRounds; ++round) {
    auto start = start_at(fit.model);
    std::vector<Eigen::Index> kept;
    for (Eigen::Index m = 0; m < start.pole.size(); ++m) {
      // No fit starts from a pole without damping: its judgement refuses such a one.
      if (!(start.pole(m).real() < 0.0 && start.pole(m).imag() > 0.0)) return;
      if (!has_no_resonance(data, start.pole(m))) kept.push_back(m);
    }
    if (kept.empty() || std::ssize(kept) == start.pole.size()) return;
    start.pole = start.pole(kept).eval();
    fit = modal_fit(data, start, options);
  }
}

Start with_mode_above(const FitData& data, Start start, Damping damping) {
  const auto known = start.pole.size();
  const double last = kTwoPi * data.frequency_hz(data.line_count() - 1);
  Eigen::VectorXcd pole = start.pole;
  for (double own = Constants::above_band * last; own < Constants::far_beyond * last;
       own *= Constants::next_above) {
    pole.conservativeResize(pole.size() + 1);
    pole(pole.size() - 1) = own * std::complex<double>(-Constants::even_damping, 1.0);
  }
  const ResidueProblem problem(data, pole, start.rigid_count > 0, damping);
  std::vector<Eigen::Index> chosen(static_cast<std::size_t>(known) + 1);
  std::iota(chosen.begin(), chosen.end(), 0);
  Eigen::Index best = known;
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index m = known; m < pole.size(); ++m) {
    chosen.back() = m;
    const double cost = problem.residues(chosen).cost;
    if (cost < least) best = m;
    least = std::min(cost, least);
  }
  start.pole.conservativeResize(known + 1);
  start.pole(known) = pole(best);
  return start;
}

Start with_modes_above(const FitData& data, Start start, Damping damping) {
  const auto room =
      data.measured_count() / (2 * parameters_of_mode(data, damping)) - start.pole.size();
  const auto added = std::clamp<Eigen::Index>(room, 0, Constants::modes_above);
  const auto known = start.pole.size();
  start.pole.conservativeResize(known + added);
  double own = kTwoPi * data.frequency_hz(data.line_count() - 1);
  for (Eigen::Index m = known; m < start.pole.size(); ++m) {
    own *= Constants::next_above;
    start.pole(m) = own * std::complex<double>(-Constants::even_damping, 1.0);
  }
  return start;
}

}  // namespace chladni::identification
