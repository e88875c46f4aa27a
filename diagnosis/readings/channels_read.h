// What a channel's record may be taken for, as effects of the catalogue.
#pragma once

#include <vector>

#include "diagnosis/effect.h"

namespace chladni::diagnosis {

/// A part of a reading; no causes: right in this respect.
struct ReadingPart {
  std::vector<Supposed> causes;  ///< a sign, a unit; a quantity, a delay; or none
  Eigen::VectorXcd factor;       ///< on the record: K; of a scale one real number
};

/// Channels that are read alike, and the readings that differ in sign and unit (`scales`: real
/// factors) and in quantity and delay (`shapes`: functions of the frequency). The first of each is
/// the right one; all pairs of the two are possible.
struct ChannelsRead {
  bool sensors = true;
  std::vector<Eigen::Index> channels;
  std::vector<ReadingPart> scales, shapes;
};

/// Each sensor, each actuator, and all sensors together, where the catalogue has readings for them.
/// @param omega  K lines [rad/s]
/// @param delays  [s], that are tried
[[nodiscard]] std::vector<ChannelsRead> channels_read(const Structure& structure,
                                                      const std::vector<const Effect*>& catalogue,
                                                      const Eigen::VectorXd& omega,
                                                      const Eigen::VectorXd& delays);

}  // namespace chladni::diagnosis
