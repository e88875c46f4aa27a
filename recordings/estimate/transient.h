// The transient of the start that remains in a periodic experiment.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "recordings/spectra.h"

namespace chladni::recordings {

/// The powers of differences between successive periods follow E|Y_{p+1} − Y_p|² = 2σ² + A
/// ρ^{2p} + A' ρ'^{2p}. All channels share the two decays. A and σ² belong to groups of
/// neighbouring lines, because a transient is largest at modes.
struct TransientReport {
  bool seen = false;       ///< more than noise: six standard deviations in a group, or overall
  double decay = 0.0;      ///< ρ: part of the slower one that one period leaves; 0: none seen
  Eigen::Index drop = 0;   ///< number of periods to drop: the first that leaves a bias below 0.1 σ
                           ///< of the mean; if no number does, the one of least error
  double remaining = 0.0;  ///< largest predicted bias after that, over the mean's deviation
  double first = 0.0;      ///< the same without dropping
  std::string text;        ///< for a person
};

/// Examines the outputs. With two periods or more at least one is dropped; a decay is only visible
/// with three or more.
/// @throws InvalidInput  no records
[[nodiscard]] TransientReport transient(const SpectraSource& spectra);
[[nodiscard]] TransientReport transient(const Spectra& spectra);

struct WithoutTransient {
  TimeData data;
  std::vector<Eigen::MatrixXcd> amplitude;  ///< [record], poles×outputs, at the record's start
};

/// The recordings without a free decay Σ 2 Re(b_m e^{p_m t}) per record and channel. Least squares
/// on the part that does not repeat gives b_m. The inputs are corrected as well if they do not
/// repeat exactly (a loop). This removes what dropped periods leave: docs/reference/experiments.md.
/// @param pole  [rad/s], Re < 0, Im > 0: from the first fit; in a loop the poles of the closed loop
/// Cost: samples·channels·poles.
/// @throws InvalidInput  fewer than two periods, or not whole ones; a pole that does not decay
[[nodiscard]] WithoutTransient without_transient(const TimeData& data,
                                                 const Eigen::VectorXcd& pole);

}  // namespace chladni::recordings
