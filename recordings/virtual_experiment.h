// A virtual laboratory: a structure is excited sample by sample, with the delay, noise,
// quantisation and loop of hardware. The code shares nothing with the estimators that use its data.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "base/draw.h"
#include "base/progress.h"
#include "recordings/excitation.h"
#include "recordings/laboratory/controller.h"
#include "recordings/laboratory/plant.h"
#include "recordings/time_data.h"

namespace chladni::recordings {

/// A spring from the structure to ground with force k y³: `output` measures y, `input` pushes.
struct CubicSpring {
  double stiffness = 0.0;  ///< [N/m³]
  Eigen::Index output = 0, input = 0;
};

/// The plant's channels come first the recorded ones, then any others (for a spring at them).
struct VirtualRig {
  Plant plant;
  std::vector<modal::MeasuredChannel> outputs, inputs;  ///< the recorded channels, at most all
  double sample_time_s = 0.0;
  double delay_s = 0.0;           ///< from the command to the force; at least one sample in a loop
  Eigen::VectorXd sensor_noise;   ///< rms, white, per recorded output; empty: none
  Eigen::VectorXd process_noise;  ///< [N], rms per sample, held, for each recorded input; or empty
  Eigen::VectorXd quantisation;   ///< step of each recorded output, 0: none; or empty
  std::optional<CubicSpring> spring;
  int substeps = 8;  ///< steps per sample with a spring: the error is of second order in the step
  std::optional<Controller> controller;
};

/// @throws InvalidInput  sizes differ, a number is negative or not finite, a loop that is unstable,
///                       without delay or of velocities
void check(const VirtualRig& rig);

/// The structure starts at rest. N samples of command drive each recorded input, held between
/// samples. In a loop the commands are references that are added to the controller's output. The
/// recorded input is the command that is sent to the hardware. The last kRateAhead samples of
/// velocities and accelerations take the forces to keep their last value.
/// Cost: samples·states·channels if linear and in open loop, else the same for every step.
/// @throws InvalidInput      as check(); the number of inputs differs
/// @throws NumericalFailure  the response grows without bound
[[nodiscard]] Record recorded(const VirtualRig& rig, const Eigen::MatrixXd& command, Draw& noise);

struct VirtualExperimentPlan {
  MultisinePlan multisine;
  InputScheme scheme = InputScheme::one_at_a_time;
  Eigen::Index periods = 10;
  Eigen::Index warm_up = 0;  ///< periods before the recorded ones
};

/// One realisation with a record for each experiment; a loop has references. `crest_factor`
/// receives the largest crest factor of the excitation.
/// @throws as experiments() and recorded()
[[nodiscard]] TimeData realisation(const VirtualRig& rig, const VirtualExperimentPlan& plan,
                                   int number, Draw& draw, double* crest_factor = nullptr);

/// What the rig records while given signals are played.
/// @param excitation  inputs of one period per record, in the rig's order
/// @param crest_factor  of the signals
/// @throws InvalidInput  other inputs or another sampling than the rig has
[[nodiscard]] TimeData played(const VirtualRig& rig, const TimeData& excitation,
                              Eigen::Index periods, Eigen::Index warm_up, Draw& draw,
                              double* crest_factor = nullptr);

/// All realisations in one data set.
[[nodiscard]] TimeData virtual_experiment(const VirtualRig& rig, const VirtualExperimentPlan& plan,
                                          int realisations, unsigned seed,
                                          const Progress& progress = {});

}  // namespace chladni::recordings
