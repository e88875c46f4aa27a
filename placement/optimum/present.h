// What a layout has beside the devices that are chosen.
#pragma once

#include <algorithm>
#include <vector>

#include "placement/plan.h"
#include "placement/wanted_modes.h"

namespace chladni::placement {

// The channels that stay, or all.
inline std::vector<std::size_t> those_there(const Channels& channels, bool all) {
  std::vector<std::size_t> chosen;
  for (Eigen::Index i = 0; i < channels.count(); ++i) {
    if (all || channels.keeps(i)) chosen.push_back(static_cast<std::size_t>(i));
  }
  return chosen;
}

// Their rows for all modes.
inline Eigen::MatrixXd rows_there(const Structure& structure, const Channels& channels, bool all) {
  const auto chosen = those_there(channels, all);
  if (chosen.empty()) return Eigen::MatrixXd(0, structure.frequency_hz.size());
  return channels.shapes(chosen, Eigen::all);
}

inline Eigen::MatrixXd stacked(const Eigen::MatrixXd& above, const Eigen::MatrixXd& below) {
  if (above.rows() == 0) return below;
  if (below.rows() == 0) return above;
  Eigen::MatrixXd both(above.rows() + below.rows(), above.cols());
  both << above, below;
  return both;
}

inline Eigen::Index site_count(const Plan& plan, const WantedModes& wanted) {
  return plan.sites > 0 ? plan.sites : std::ssize(wanted.columns) + 1;
}

inline DeviceCounts devices_of(const Plan& plan, const WantedModes& wanted) {
  if (plan.devices.all() > 0) return plan.devices;
  return {.sensors = static_cast<int>(site_count(plan, wanted))};
}

// What the layout of an observer has beside what is chosen.
inline Eigen::MatrixXd sensors_there(const Structure& structure, const DeviceCounts& counts) {
  return rows_there(structure, structure.sensors, counts.sensors == 0 && counts.pairs == 0);
}
inline Eigen::MatrixXd actuators_there(const Structure& structure, const DeviceCounts& counts) {
  return rows_there(structure, structure.actuators, counts.only_sensors());
}

}  // namespace chladni::placement
