#include "identification/channel_gains.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/diagonal.h"
#include "base/error.h"
#include "identification/constants.h"
#include "identification/gains/pair_evidence.h"
#include "identification/suspension.h"
#include "priors/learned_corrections.h"

namespace chladni::identification {
namespace {

constexpr double kLargestMode = 0.15;  // deviation of ln f between a mode and its simulation

Eigen::Index channel_index(const std::vector<modal::MeasuredChannel>& channels,
                           const std::string& name) {
  const auto found = std::ranges::find(channels, name, &modal::MeasuredChannel::name);
  return found == channels.end() ? -1 : found - channels.begin();
}

// Distance of the two places of a pair along the sensor's direction and across it [m].
struct Apart {
  double along, across;
};

Apart apart(const modal::FrfSet& channels, const CollocatedPair& pair) {
  const auto& output = channels.outputs[static_cast<std::size_t>(pair.output)];
  const auto& input = channels.inputs[static_cast<std::size_t>(pair.input)];
  const Eigen::Vector3d between = *output.position - *input.position;
  const double along = output.direction.dot(between);
  return {std::abs(along), (between - along * output.direction).norm()};
}

double diagonal_of_places(const modal::FrfSet& channels) {
  Points places(std::ssize(channels.outputs) + std::ssize(channels.inputs), 3);
  Eigen::Index row = 0;
  for (const auto* side : {&channels.outputs, &channels.inputs}) {
    for (const auto& channel : *side) places.row(row++) = channel.position->transpose();
  }
  return diagonal_of(places);
}

// Diagonals of the body [m] that decide on the distances of pairs along and across their lines.
struct Sizes {
  double along, across;
};

bool is_apart(const modal::FrfSet& channels, const CollocatedPair& pair, const Sizes& size) {
  const auto [along, across] = apart(channels, pair);
  return across > Constants::beside_place * size.across ||
         along > Constants::through_place * size.along;
}

// The size of the body, at least that of its channels, which does where no pair needs more. Where
// it is not known it is infinite along the lines: plates may be thick. Across them it is then that
// of the channels.
Sizes sizes_of(const modal::FrfSet& channels, const std::vector<CollocatedPair>& pairs,
               const GainSimulation& simulation) {
  const double seen = diagonal_of_places(channels);
  const Sizes least{seen, seen};
  const bool is_near = std::ranges::none_of(
      pairs, [&](const auto& pair) { return is_apart(channels, pair, least); });
  if (is_near) return least;
  if (!simulation.size_m) return {std::numeric_limits<double>::infinity(), seen};
  const double body = std::max(seen, simulation.size_m());
  return {body, body};
}

double alike(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return std::pow(a.dot(b), 2) / std::max(1e-300, a.squaredNorm() * b.squaredNorm());
}

// The simulated mode that is most like a fitted mode, on both sides and in frequency.
Eigen::Index simulated_mode(const modal::ReducedModel& fit, Eigen::Index mode,
                            const SimulatedChannels& simulation) {
  const auto& frequency = simulation.frequency_hz;
  const Eigen::Index rigid = (frequency.array() == 0.0).count();
  Eigen::Index best = rigid;
  double likeness = -1.0;
  for (auto r = rigid; r < frequency.size(); ++r) {
    const double ratio = std::log(fit.frequency_hz(mode) / frequency(r)) / kLargestMode;
    const double here = alike(fit.output_shapes.col(mode), simulation.outputs.col(r)) *
                        alike(fit.input_shapes.row(mode).transpose(), simulation.inputs.col(r)) *
                        std::exp(-0.5 * ratio * ratio);
    if (here > likeness) {
      likeness = here;
      best = r;
    }
  }
  return best;
}

// Adds the simulated shapes at the two places of each pair that are apart, mode by mode.
void add_simulated_shapes(const modal::ReducedModel& fit, const modal::FrfSet& channels,
                          const SimulatedChannels& simulation, const Sizes& size,
                          std::vector<CollocatedPair>& pairs) {
  const auto m = fit.mode_count();
  for (auto& pair : pairs) {
    if (!is_apart(channels, pair, size)) continue;
    pair.at_output.setConstant(m, pair.sign);
    pair.at_input.setOnes(m);
    for (auto mode = fit.rigid_count; mode < m; ++mode) {
      const auto r = simulated_mode(fit, mode, simulation);
      pair.at_output(mode) = simulation.outputs(pair.output, r);
      pair.at_input(mode) = simulation.inputs(pair.input, r);
    }
  }
}

// Number of rigid-body motions along z that the channels' places can tell apart: 2 for a line along
// x, 3 for a plane.
Eigen::Index motions_told(const modal::FrfSet& seen) {
  double least = std::numeric_limits<double>::infinity();
  double most = -least;
  for (const auto* side : {&seen.outputs, &seen.inputs}) {
    for (const auto& channel : *side) {
      least = std::min(least, channel.position->y());
      most = std::max(most, channel.position->y());
    }
  }
  return most - least > Constants::beside_place * diagonal_of_places(seen) ? 3 : 2;
}

// Geometry of rigid-body motions, if all channels move along z and their places are distinct.
std::optional<RigidGeometry> geometry_of(const modal::FrfSet& seen, Eigen::Index motions) {
  const auto rows = [&](const std::vector<modal::MeasuredChannel>& channels) {
    Eigen::MatrixX3d places(static_cast<Eigen::Index>(channels.size()), 3);
    Eigen::VectorXd sign(places.rows());
    for (std::size_t i = 0; i < channels.size(); ++i) {
      places.row(static_cast<Eigen::Index>(i)) = channels[i].position->transpose();
      sign(static_cast<Eigen::Index>(i)) = channels[i].direction.z();
    }
    return Eigen::MatrixXd(sign.asDiagonal() * rigid_directions(places, rigid_motion(motions)));
  };
  const auto along_z = [](const auto& channel) { return std::abs(channel.direction.z()) > 0.999; };
  if (!std::all_of(seen.outputs.begin(), seen.outputs.end(), along_z) ||
      !std::all_of(seen.inputs.begin(), seen.inputs.end(), along_z)) {
    return std::nullopt;
  }
  RigidGeometry geometry{rows(seen.outputs), rows(seen.inputs), {}, 0.0, true};
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> outputs(geometry.outputs);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> inputs(geometry.inputs);
  if (std::max(outputs.rank(), inputs.rank()) < motions) return std::nullopt;
  return geometry;
}

// Rigid-body motion: at 0 Hz, or on the springs that hold the body.
std::optional<RigidGeometry> rigid_geometry(const ModalFit& fit, const modal::FrfSet& channels,
                                            const GainPlan& plan) {
  const auto rigid = fit.model.rigid_count;
  if (rigid > 0) {
    // Two modes are a beam's where the places lie on its line. Elsewhere they are a part of the
    // motions of a plate, such as two actuators drive.
    const bool is_whole = rigid == 3 || (rigid == 2 && motions_told(channels) == 2);
    return is_whole ? geometry_of(channels, rigid) : std::nullopt;
  }
  if (plan.suspended_modes == 0) return std::nullopt;
  auto geometry = geometry_of(channels, motions_told(channels));
  require(geometry || plan.suspended_modes < 0,
          plan.source +
              "identification.suspended_modes needs channels that all act along z, on one side as "
              "many as tell the motions of the body as a whole apart");
  if (!geometry) return std::nullopt;
  if (plan.suspended_modes < 0 && plan.is_supported) return std::nullopt;
  const auto found =
      plan.suspended_modes > 0
          ? stated_suspension(fit, geometry->outputs, geometry->inputs, plan.suspended_modes)
          : suspension(fit, geometry->outputs, geometry->inputs);
  geometry->suspended = found.modes;
  // Thesis 5.2.6 is its remedy against blended modes. For other modes it loses information of the
  // actuators.
  geometry->pairs_first = plan.rule != GainRule::thesis || plan.suspended_modes < 0;
  geometry->bending = found.bending;
  return geometry;
}

// The flexible shapes at the side with more channels. A channel that was not measured has no
// deviation in any mode and is left out.
priors::MeasuredShapes shapes_of_one_side(const ModalFit& fit, const GainPrior& prior) {
  const bool sensors = prior.outputs.count() >= prior.inputs.count();
  const Eigen::MatrixXd values =
      sensors ? fit.model.output_shapes : fit.model.input_shapes.transpose();
  const Eigen::MatrixXd noise = sensors ? fit.output_std : fit.input_std.transpose();
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < noise.rows(); ++i) {
    if (noise.row(i).tail(fit.flexible_count()).array().isFinite().any()) rows.push_back(i);
  }
  std::vector<Eigen::Index> modes;
  for (auto m = fit.model.rigid_count; m < fit.model.mode_count() && !rows.empty(); ++m) {
    const Eigen::VectorXd own = noise.col(m)(rows);
    if (own.allFinite() && own.minCoeff() > 0.0) modes.push_back(m);
  }
  return {priors::part(sensors ? prior.outputs : prior.inputs, rows), fit.model.frequency_hz(modes),
          values(rows, modes), noise(rows, modes)};
}

GainPrior corrected(const GainPrior& plain, const priors::CorrectedSimulation& simulation) {
  const auto& turn = simulation.modes.turn;
  GainPrior prior{plain.outputs, plain.inputs,
                  priors::corrected_basis(plain.basis, simulation.modes), simulation.errors.prior};
  prior.outputs.shapes = plain.outputs.shapes * turn;
  prior.inputs.shapes = plain.inputs.shapes * turn;
  return prior;
}

// True if the scale of a flexible mode was not found.
bool lacks_a_scale(const GainMatch& match, Eigen::Index rigid_count) {
  return std::any_of(match.modes.begin() + rigid_count, match.modes.end(),
                     [](const auto& mode) { return mode.by == MatchedBy::nothing; });
}

}  // namespace

std::vector<CollocatedPair> channel_pairs(const GainPlan& plan, const modal::FrfSet& channels) {
  if (plan.pairs.empty()) {
    return collocated_pairs(channels.outputs, channels.inputs, plan.pairs_within);
  }
  std::vector<CollocatedPair> pairs;
  for (const auto& [sensor, actuator] : plan.pairs) {
    CollocatedPair pair;
    pair.output = channel_index(channels.outputs, sensor);
    pair.input = channel_index(channels.inputs, actuator);
    if (pair.output < 0 || pair.input < 0) continue;
    pair.sign = sign_of_pair(channels.outputs[static_cast<std::size_t>(pair.output)],
                             channels.inputs[static_cast<std::size_t>(pair.input)]);
    pairs.push_back(std::move(pair));
  }
  return pairs;
}

ChannelGains channel_gains(const ModalFit& fit, const modal::FrfSet& channels, const GainPlan& plan,
                           const GainSimulation& simulation) {
  for (const auto* side : {&channels.outputs, &channels.inputs}) {
    for (const auto& channel : *side) {
      require(channel.position.has_value(),
              plan.source + "channel " + channel.name + " has no place, which its gain needs");
    }
  }
  ChannelGains gains;
  gains.pairs = channel_pairs(plan, channels);
  const auto size = sizes_of(channels, gains.pairs, simulation);
  if (plan.pairs.empty()) {
    std::erase_if(gains.pairs, [&](const auto& pair) {
      return apart(channels, pair).along > Constants::through_pair * size.along;
    });
  }
  const bool some_apart = std::ranges::any_of(
      gains.pairs, [&](const auto& pair) { return is_apart(channels, pair, size); });
  if (some_apart && simulation.at_channels) {
    add_simulated_shapes(fit.model, channels, simulation.at_channels(), size, gains.pairs);
  }
  GainMatchOptions options;
  options.pairs = gains.pairs;
  options.rule = plan.rule;
  options.fault = plan.fault;
  gains.corrects_gains = plan.fault != GainFault::nobody;
  options.geometry = rigid_geometry(fit, channels, plan);
  gains.match = gain_match(fit, channels.outputs, channels.inputs, options);
  if (simulation.prior && lacks_a_scale(gains.match, fit.model.rigid_count)) {
    options.prior = simulation.prior();
    gains.match = gain_match(fit, channels.outputs, channels.inputs, options);
  }
  return gains;
}

GainPrior simulated_gain_prior(const ModalFit& fit, const priors::Simulation& simulation,
                               const priors::Places& outputs, const priors::Places& inputs) {
  constexpr Eigen::Index kFewestPlaces = 3;  // as for an interpolation
  const GainPrior plain{outputs, inputs, priors::modal_basis(simulation), {}};
  const auto shapes = shapes_of_one_side(fit, plain);
  if (shapes.places.count() < kFewestPlaces || shapes.mode_count() == 0) return plain;
  const auto learned = priors::learned_corrections(shapes, plain.basis, simulation.corrections);
  auto prior = corrected(plain, learned.likeliest);
  for (const auto& other : learned.aside) prior.aside.push_back(corrected(plain, other));
  // One or two of dozens of corrections are by chance far from plausible. `aside` holds what that
  // means.
  prior.doubts = learned.doubts;
  return prior;
}

RigidMotion rigid_motion(Eigen::Index rigid_count) {
  return rigid_count == 2 ? RigidMotion::beam : RigidMotion::plate;
}

}  // namespace chladni::identification
