// What an experiment's lines carry: responses of the simulated structure and their noise.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identification/experiment_design.h"

namespace chladni::identification {

/// Samples of a period, or of the record of a blow, at most: as many as a study may state.
inline constexpr double kMostSamples = 1 << 24;

/// K lines, all outputs (P) and inputs (q) of the model.
struct DesignLines {
  Eigen::Index period = 0;  ///< samples
  std::vector<Eigen::Index> index;
  Eigen::VectorXd hz;
  Eigen::VectorXd hold;                    ///< K: magnitude of a force that is held between samples
  std::vector<Eigen::MatrixXcd> response;  ///< [k], P×q: displacements, with the hold
};

/// The period that resolves the narrowest mode in the band: an even number of samples without prime
/// factors above 5, at most kMostSamples.
[[nodiscard]] Eigen::Index period_for(const modal::ReducedModel& model, const DesignPlan& plan);

/// Modes of the model in the band, without those at 0 Hz.
[[nodiscard]] std::vector<Eigen::Index> modes_in_band(const modal::ReducedModel& model,
                                                      const DesignPlan& plan);

[[nodiscard]] DesignLines design_lines(const DesignModel& model, const DesignPlan& plan,
                                       Eigen::Index period, unsigned seed);

/// K×p: |s|^{2 kind}, what a sensor measures over the displacement, squared.
[[nodiscard]] Eigen::MatrixXd kind_power(const std::vector<modal::FrfKind>& kinds,
                                         const Eigen::VectorXd& hz);

/// K×p: E|N|² of a transform over one period, in the sensors' units squared, from sensors and
/// process noise.
[[nodiscard]] Eigen::MatrixXd noise_power(const DesignModel& model, const DesignPlan& plan,
                                          const DesignLines& lines,
                                          const Eigen::VectorXd& sensor_noise);

/// How many experiments of one realisation excite each input.
[[nodiscard]] double excitations(const DesignPlan& plan, Eigen::Index inputs);

}  // namespace chladni::identification
