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

/// Scales one group of modes with the information available; without any it adds a warning.
void match_group(Matching& state, std::size_t group);

/// +1 or −1 for all inputs from the suspended modes' geometry, if no pair gives the sign.
[[nodiscard]] int side_by_motion(const Matching& state);

}  // namespace chladni::identification
