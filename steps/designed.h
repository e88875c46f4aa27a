// The experiment that a study wants to make, designed on its simulated modes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identification/experiment_design.h"
#include "identification/hammer_design.h"
#include "placement/sites.h"
#include "recordings/time_data.h"
#include "stage/solution.h"

namespace chladni::steps {

struct DesignedExperiment {
  std::optional<identification::ExperimentDesign> multisine;
  std::optional<identification::HammerDesign> hammer;
  placement::Sites points;       ///< of the blows, in the order of hammer->points
  Eigen::VectorXd sensor_noise;  ///< as stated; in the sensors' units
  double low_hz = 0.0, high_hz = 0.0;
  Eigen::Index rigid_count = 0;
  std::vector<std::string> notes;

  [[nodiscard]] const std::vector<identification::ExpectedMode>& modes() const {
    return multisine ? multisine->modes : hammer->modes;
  }
  [[nodiscard]] double duration_s() const {
    return multisine ? multisine->duration_s : hammer->duration_s;
  }
};

/// @throws InvalidInput  no [design] or [experiment], no sensor, no actuator for a multisine
void require_design(const study::Study& study);

/// @throws InvalidInput  as require_design, experiment_design() and hammer_design()
[[nodiscard]] DesignedExperiment designed(const study::Study& study,
                                          const stage::Solution& solution, stage::Work& work);

/// One period of every experiment and realisation, as commands: in N, or in V where the study says
/// how many newtons a volt gives.
[[nodiscard]] recordings::TimeData excitation_of(const study::Study& study,
                                                 const identification::ExperimentDesign& design);

/// What is played in one experiment, samples×q, as commands: identification::sequence.
/// @throws InvalidInput  there is no such realisation or experiment, both counted from 0
[[nodiscard]] Eigen::MatrixXd sequence_of(const study::Study& study,
                                          const identification::ExperimentDesign& design,
                                          std::size_t realisation, std::size_t experiment);

/// "N" or "V", and what a newton is in it.
[[nodiscard]] std::string command_unit(const study::Study& study);
[[nodiscard]] double command_per_newton(const study::Study& study);

}  // namespace chladni::steps
