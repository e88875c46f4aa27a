// A laboratory that does not exist: a structure shaken sample by sample, with the hardware's delay,
// noise, quantisation and loop. It uses no code of the estimators that it feeds.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "base/draw.h"
#include "base/progress.h"
#include "identification/experiment/controller.h"
#include "identification/experiment/excitation.h"
#include "identification/experiment/plant.h"
#include "identification/time_data.h"

namespace chladni::identification {

/// A spring to ground of force k y³ where `output` measures a displacement and `input` pushes.
struct CubicSpring {
  double stiffness = 0.0;  ///< [N/m³]
  Eigen::Index output = 0, input = 0;
};

/// Channels beyond the recorded ones are at the end of the plant's (for a spring between them).
struct VirtualRig {
  Plant plant;
  std::vector<modal::MeasuredChannel> outputs, inputs;  ///< recorded: at most the plant's
  double sample_time_s = 0.0;
  double delay_s = 0.0;           ///< from the command to the force; one sample or more in a loop
  Eigen::VectorXd sensor_noise;   ///< rms, white, per recorded output; empty: none
  Eigen::VectorXd process_noise;  ///< [N], rms per sample, held, on each recorded input; or empty
  Eigen::VectorXd quantisation;   ///< step of each recorded output, 0: none; or empty
  std::optional<CubicSpring> spring;
  int substeps = 8;  ///< of a sample, with a spring: error of second order in them
  std::optional<Controller> controller;
};

/// @throws InvalidInput  sizes differ, a number is negative or not finite, a loop that is unstable
///                       or without delay
void check(const VirtualRig& rig);

/// The structure starts at rest and is driven by N samples of command for each recorded input, held
/// between samples; in a loop they are references, added to what the controller asks for. What is
/// recorded as input is the command that left for the hardware.
/// Cost: linear and open loop samples·states·(channels), else as much in steps.
/// @throws InvalidInput      as check(); another number of inputs
/// @throws NumericalFailure  the response grows without bound
[[nodiscard]] Record recorded(const VirtualRig& rig, const Eigen::MatrixXd& command, Draw& noise);

struct VirtualExperimentPlan {
  MultisinePlan multisine;
  InputScheme scheme = InputScheme::one_at_a_time;
  Eigen::Index periods = 10;
  Eigen::Index warm_up = 0;  ///< periods before those recorded
};

/// One realisation, a record for each experiment; in a loop with references. `crest_factor` gets
/// the largest of the excitation.
/// @throws as experiments() and recorded()
[[nodiscard]] TimeData realisation(const VirtualRig& rig, const VirtualExperimentPlan& plan,
                                   int number, Draw& draw, double* crest_factor = nullptr);

/// All realisations in one.
[[nodiscard]] TimeData virtual_experiment(const VirtualRig& rig, const VirtualExperimentPlan& plan,
                                          int realisations, unsigned seed,
                                          const Progress& progress = {});

}  // namespace chladni::identification
