// What is left in a periodic experiment of how it began.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identification/estimate/spectra.h"

namespace chladni::identification {

/// Differences of successive periods, E|Y_{p+1} − Y_p|² = 2σ² + A ρ^{2p} + A' ρ'^{2p}, with two
/// decays for all channels, A and σ² of groups of neighbouring lines, because a transient is
/// largest at modes.
struct TransientReport {
  bool seen = false;       ///< more than noise (six standard deviations in a group, or overall)
  double decay = 0.0;      ///< ρ, what one period leaves of the slower one; 0 where none is seen
  Eigen::Index drop = 0;   ///< the periods to drop: so many that less than 0.1 σ of the mean
                           ///< remains, or, where no number does, that the error is least
  double remaining = 0.0;  ///< largest predicted bias then, over the deviation of the mean
  double first = 0.0;      ///< the same with nothing dropped
  std::string text;        ///< for a person
};

/// Looks at the outputs. One period is dropped in any case where there are two; three are needed to
/// see a decay.
/// @throws InvalidInput  no records
[[nodiscard]] TransientReport transient(const Spectra& spectra);

struct WithoutTransient {
  TimeData data;
  std::vector<Eigen::MatrixXcd> amplitude;  ///< [record], poles×outputs, at the record's start
};

/// The recordings less a free decay Σ 2 Re(b_m e^{p_m t}) per record and channel, b_m by least
/// squares on what does not repeat; inputs too where they do not repeat exactly (a loop). Removes
/// what dropping periods does not: docs/reference/experiments.md.
/// @param pole  [rad/s], Re < 0, Im > 0: of the first fit; of the closed loop where there is one
/// Cost: samples·channels·poles.
/// @throws InvalidInput  fewer than two periods, or not whole ones; a pole that does not decay
[[nodiscard]] WithoutTransient without_transient(const TimeData& data,
                                                 const Eigen::VectorXcd& pole);

}  // namespace chladni::identification
