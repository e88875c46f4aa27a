// Places and faces in the form of a study.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace chladni::study {

/// A place in the study; `places_of` finds it on the body.
struct Place {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< [m]
  bool from_above = false;  ///< two coordinates: the highest point at (x, y); z is 0 then
  int line = 0;             ///< of the study, for messages
};

/// Faces in the study; `faces_of` finds them on the body.
struct FacePlan {
  std::vector<std::string> patches;       ///< names
  std::optional<Eigen::Vector3d> facing;  ///< unit: faces in this direction, instead of patches
  int line = 0, column = 0;               ///< of the study, for messages; 0: not stated

  [[nodiscard]] bool empty() const { return patches.empty() && !facing; }
};

}  // namespace chladni::study
