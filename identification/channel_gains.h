// One scale for sensors and actuators of a fit, from its channels and a simulation of them.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "identification/gain_match.h"
#include "priors/interpolator.h"

namespace chladni::identification {

/// How the two sides of each mode get one scale.
struct GainPlan {
  std::vector<std::pair<std::string, std::string>> pairs;  ///< names of sensor and actuator
  /// Channels on one line that are pairs where none are named [m]; not a part of the body, so that
  /// one of millimetres needs less.
  double pairs_within = 1e-3;
  GainRule rule = GainRule::tied;
  GainFault fault = GainFault::nobody;  ///< the side whose gains the pairs correct
  int suspended_modes = -1;   ///< above 0 Hz in which the body moves as a whole; −1: found
  bool is_supported = false;  ///< its supports let it not move as a whole: no such mode is sought
  std::string source;         ///< stands before messages, such as a file's name and ": "; or empty
};

/// A simulation at the channels of a fit: r modes, rigid-body modes at 0 Hz first.
struct SimulatedChannels {
  Eigen::VectorXd frequency_hz;     ///< r
  Eigen::MatrixXd outputs, inputs;  ///< p×r, q×r [kg^-1/2], in the order of the fit's channels
};

/// A simulation where it is needed. Each function may be empty.
struct GainSimulation {
  std::function<SimulatedChannels()> at_channels;  ///< for pairs whose two places differ
  std::function<GainPrior()> prior;                ///< for modes that no pair scales
  /// The diagonal of the body [m]: what is one place, and what is near, are parts of it. A sensor
  /// and an actuator that act along one line are in one place on the two faces of a plate, not at
  /// the ends of a bar; without it they are wherever they are.
  std::function<double()> size_m = {};
};

struct ChannelGains {
  GainMatch match;
  std::vector<CollocatedPair> pairs;
  bool corrects_gains = false;  ///< the pairs correct the gains of one side
};

/// The pairs of the plan, else channels on one line within `pairs_within` of each other. Names that
/// the channels lack are left out.
[[nodiscard]] std::vector<CollocatedPair> channel_pairs(const GainPlan& plan,
                                                        const modal::FrfSet& channels);

/// Matches the gains by the pairs, by rigid-body motion and by the simulation. Pairs that are not
/// named and lie farther apart along their line than a quarter of the body are none.
/// @param channels  those of the fit, with their places and directions
/// @throws InvalidInput  as `gain_match` and `stated_suspension`; suspended modes are stated, but
///                       the channels do not all act along z
[[nodiscard]] ChannelGains channel_gains(const ModalFit& fit, const modal::FrfSet& channels,
                                         const GainPlan& plan, const GainSimulation& simulation);

/// The prior of a simulation for the scale of modes without a pair, corrected by the shapes of the
/// side with more channels: each has its own scale there, so that gains do not matter. What these
/// leave uncertain of the corrections is in `aside`, and thus in the deviation of each scale. Fewer
/// than three places teach nothing: the simulation is then taken as it is, with the errors of
/// DynamicResidual, which are wide enough for a usual one.
/// @param outputs, inputs  the channels of the fit, with the simulation's modes
[[nodiscard]] GainPrior simulated_gain_prior(const ModalFit& fit,
                                             const priors::Simulation& simulation,
                                             const priors::Places& outputs,
                                             const priors::Places& inputs);

/// Rigid-body motion with this number of rigid-body modes, all channels along z.
[[nodiscard]] RigidMotion rigid_motion(Eigen::Index rigid_count);

}  // namespace chladni::identification
