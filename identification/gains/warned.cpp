#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "identification/gains/matching.h"
#include "identification/gains/pair_evidence.h"

namespace chladni::identification {
namespace {

// Names the parts of the told gains, if there are several.
void warn_of_gain_parts(Matching& state) {
  const auto& gains = state.match.pairs;
  const auto count = gain_parts(gains);
  if (count < 2) return;
  std::vector<std::string> parts;
  for (Eigen::Index part = 0; part < count; ++part) {
    std::vector<std::string> names;
    for (std::size_t c = 0; c < gains.size(); ++c) {
      if (gains[c].modes == 0 || gains[c].part != part) continue;
      names.push_back(state.pair_name(static_cast<Eigen::Index>(c)));
    }
    parts.push_back(fmt::format("{}", fmt::join(names, ", ")));
  }
  state.match.warnings.push_back(fmt::format(
      "no mode compares the gains of some pairs with those of others: each gain is that over the "
      "pairs of its part, that between the parts is not known ({})",
      fmt::join(parts, "; ")));
}

}  // namespace

void warn_of_gains(Matching& state, const Eigen::MatrixXd& left) {
  warn_of_gain_parts(state);
  const char* whole =
      gain_parts(state.match.pairs) > 1 ? "the pairs of its part together" : "the pairs together";
  for (std::size_t c = 0; c < state.match.pairs.size(); ++c) {
    const auto& gain = state.match.pairs[c];
    const auto row = static_cast<Eigen::Index>(c);
    if (gain.modes > 0 && std::abs(gain.ratio - 1.0) > std::max(3.0 * gain.part_std, 1e-3)) {
      state.match.warnings.push_back(fmt::format(
          "{}: the sensor's gain over the actuator's is {:.4f} +- {:.4f} of that of "
          "{}{}",
          state.pair_name(row), gain.ratio, gain.part_std, whole,
          state.options.fault == GainFault::nobody ? ", not corrected" : ", corrected"));
    }
    for (std::size_t g = 0; g < state.groups.size(); ++g) {
      const double off = left(row, static_cast<Eigen::Index>(g));
      if (std::abs(off) < 5.0) continue;
      state.match.warnings.push_back(
          fmt::format("{}: {} disagrees with the gains of the others by {:.1f} deviations; it is "
                      "not one place, or the mode is blended with another",
                      state.pair_name(row), state.mode_name(state.groups[g]), std::abs(off)));
    }
  }
}

void warn_of_disagreement(Matching& state) {
  for (const auto& group : state.groups) {
    const auto& told = state.match.modes[static_cast<std::size_t>(group.first)];
    if (!contradicted(told)) continue;
    state.match.warnings.push_back(fmt::format(
        "{}: {} disagree by chi-square {:.3g} where {} is expected", state.mode_name(group),
        told.by == MatchedBy::geometry ? "the places and a rigid motion" : "its pairs",
        told.disagreement, told.freedoms));
  }
}

void warn_of_prior(Matching& state) {
  const auto by_prior = [](const ModeMatch& mode) { return mode.by == MatchedBy::prior; };
  if (!state.options.prior || std::ranges::none_of(state.match.modes, by_prior)) return;
  for (const auto& doubt : state.options.prior->doubts) {
    state.match.warnings.push_back("the simulation, which scales modes without a pair: " + doubt);
  }
}

}  // namespace chladni::identification
