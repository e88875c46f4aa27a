// What a designed experiment will tell: deviations of modes, coherence, time.
#pragma once

#include "identification/experiment/design_lines.h"

namespace chladni::identification {

/// Motion of a mode at its best channel over its largest, below which its nodal line is near.
inline constexpr double kHardlyMoves = 0.02;

struct QualityInputs {
  const DesignModel& model;  ///< without dashpots
  const DesignPlan& plan;
  const DesignLines& lines;
  Eigen::MatrixXd power;  ///< K×q: |U|² of all experiments of a realisation
  Eigen::MatrixXd noise;  ///< K×p: E|N|² of one period
  const std::vector<Eigen::Index>& within_reach;  ///< of the modes in the band
};

/// Averages that the wanted deviations need, from the deviations after one.
[[nodiscard]] double averages_needed(const ExpectedMode& mode, double frequency_std_hz,
                                     double damping_std);

/// Coherence of each response, inputs slowest.
/// @param response  [k], P×q: displacements; the first p rows count
/// @param kinds     K×p: kind_power
/// @param power     K×q: |U|² of one experiment
/// @param noise     K×p: E|N|²
[[nodiscard]] std::vector<ExpectedCoherence> expected_coherence(
    const Eigen::VectorXd& hz, const std::vector<Eigen::MatrixXcd>& response,
    const Eigen::MatrixXd& kinds, const Eigen::MatrixXd& power, const Eigen::MatrixXd& noise);

/// Sets modes, periods, duration_s and coherence of the design.
void set_expected_quality(const QualityInputs& inputs, ExperimentDesign& design);

}  // namespace chladni::identification
