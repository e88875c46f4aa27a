// The state of gain_match during its loop over the modes.
#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identification/gain_match.h"
#include "identification/gains/pair_evidence.h"

namespace chladni::identification {

using Channels = std::vector<modal::MeasuredChannel>;

// All that is known before a mode is scaled, and the results.
struct Matching {
  ModalFit fit;  // channel gains are corrected where the options require it
  const Channels& outputs;
  const Channels& inputs;
  const GainMatchOptions& options;
  std::vector<modal::ModeGroup> groups;
  PlaceRatios ratios;
  PairResidues residues;
  Eigen::VectorXi signs;  // per pair, without the sign of the side
  int side = 1;
  GainMatch match;
  Eigen::MatrixXd at_inputs, at_inputs_std;  // q×m: shape rows at the actuators

  [[nodiscard]] Eigen::Index p() const { return fit.model.output_count(); }
  [[nodiscard]] Eigen::Index q() const { return fit.model.input_count(); }
  [[nodiscard]] std::string pair_name(Eigen::Index c) const {
    const auto& pair = options.pairs[static_cast<std::size_t>(c)];
    return outputs[static_cast<std::size_t>(pair.output)].name + "/" +
           inputs[static_cast<std::size_t>(pair.input)].name;
  }
  [[nodiscard]] std::string mode_name(const modal::ModeGroup& group) const {
    const double frequency = fit.model.frequency_hz(group.first);
    if (group.size == 1) return fmt::format("mode {} ({:.4g} Hz)", group.first + 1, frequency);
    return fmt::format("modes {} to {} ({:.4g} Hz)", group.first + 1, group.first + group.size,
                       frequency);
  }
};

/// Warns of pairs whose gains differ, are in several parts, or contradict those of the others.
/// @param left  PairGains::left
void warn_of_gains(Matching& state, const Eigen::MatrixXd& left);

/// Warns of modes whose pairs or places contradict each other.
void warn_of_disagreement(Matching& state);

/// Warns of what is doubtful of the simulation, if it scaled a mode.
void warn_of_prior(Matching& state);

/// Scales one group of modes with the information available; without any it adds a warning.
void match_group(Matching& state, std::size_t group);

/// Both sides of a single mode as fitted, with the sign of the side.
[[nodiscard]] TwoSides sides_of(const Matching& state, std::size_t group);

/// The same with the other sign of the inputs.
[[nodiscard]] TwoSides turned(TwoSides sides);

/// The shapes of a block of g modes, p×g and g×q.
struct BlockSides {
  Eigen::MatrixXd outputs, inputs;
};
/// The same of a block.
[[nodiscard]] BlockSides fitted_block(const Matching& state, const modal::ModeGroup& group);

/// Whether the geometry states that the body moves as a whole in this mode above 0 Hz.
[[nodiscard]] bool is_suspended(const Matching& state, Eigen::Index mode);

/// Whether the geometry tells the mass of these modes at 0 Hz: all motions of the body take part.
[[nodiscard]] bool tells_mass(const Matching& state, const modal::ModeGroup& group);

/// Where the motions that tell the sign of the inputs stand.
enum class ToldSide { nothing, suspended, at_zero };

/// +1 or −1 for all inputs, if no pair gives the sign: from the geometry of the suspended modes,
/// and from the modes at 0 Hz, since the mass of a body is positive.
struct SideByMotion {
  int side = 1;
  ToldSide by = ToldSide::nothing;
};
[[nodiscard]] SideByMotion side_by_motion(const Matching& state);

}  // namespace chladni::identification
