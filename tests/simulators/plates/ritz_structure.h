// The plate as the simulation for a diagnosis. Data of other Ritz plates then differ from it only
// by the changes that were made.
#pragma once

#include "diagnosis/structure.h"
#include "simulators/plates/ritz_plate.h"
#include "simulators/tables/table_channels.h"

namespace chladni::simulators {

struct RitzStructureOptions {
  Eigen::Index modes = 64;  ///< including rigid modes; the other modes give the residual
  double damping_ratio = 5e-3;
  int cells = 12;  ///< of the body, along each side
  int fine = 24;   ///< fine cells along each side, for local soft or stiff places
  int scan = 41;   ///< places along each side, from rim to rim
};

/// The structure of a plate. The chart is x and y of the top, which is z = 0 in the body's frame.
/// Cost: 0.5 s.
/// @throws InvalidInput  a channel off the plate, more modes than the basis has
[[nodiscard]] diagnosis::Structure ritz_structure(const RitzModes& plate,
                                                  const TableChannels& channels,
                                                  const RitzStructureOptions& options = {});

}  // namespace chladni::simulators
