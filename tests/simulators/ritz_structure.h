// The plate as a simulation that a diagnosis starts from: data of other Ritz plates then differ
// from it by what was changed, and by nothing else.
#pragma once

#include "diagnosis/structure.h"
#include "simulators/ritz_plate.h"
#include "simulators/table_channels.h"

namespace chladni::simulators {

struct RitzStructureOptions {
  Eigen::Index modes = 64;  ///< rigid ones in it; the others give the residual
  double damping_ratio = 5e-3;
  int cells = 12;  ///< of the body, along each side
  int fine = 24;   ///< likewise, for what is soft or stiff in one place
  int scan = 41;   ///< places along each side, from rim to rim
};

/// Chart: x and y of the top, which is z = 0 in the body's frame. Cost: 0.5 s.
/// @throws InvalidInput  a channel off the plate, more modes than the basis has
[[nodiscard]] diagnosis::Structure ritz_structure(const RitzModes& plate,
                                                  const TableChannels& channels,
                                                  const RitzStructureOptions& options = {});

}  // namespace chladni::simulators
