// A place as a study names it.
#pragma once

#include <Eigen/Core>

namespace chladni::app {

/// Where on the body it is, `places_of` finds out.
struct Place {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< [m]
  bool from_above = false;  ///< two coordinates: the highest point below (x, y); z is 0 then
  int line = 0;             ///< of the study, for messages
};

}  // namespace chladni::app
