// Places and faces as a study names them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace chladni::app {

/// Where on the body it is, `places_of` finds out.
struct Place {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< [m]
  bool from_above = false;  ///< two coordinates: the highest point below (x, y); z is 0 then
  int line = 0;             ///< of the study, for messages
};

/// On which faces of the body something is; which they are, `faces_of` finds out.
struct FacePlan {
  std::vector<std::string> patches;       ///< names
  std::optional<Eigen::Vector3d> facing;  ///< unit: the faces that look along it, instead
  int line = 0, column = 0;               ///< of the study, for messages; 0: it says nothing

  [[nodiscard]] bool empty() const { return patches.empty() && !facing; }
};

}  // namespace chladni::app
