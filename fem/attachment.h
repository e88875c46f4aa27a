// What hangs on the body or holds it.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "mesh/site.h"

namespace chladni::fem {

/// A mass at a site; with rotary inertia it follows the rotation of the material there.
struct PointMass {
  double mass = 0.0;                                          ///< [kg]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();          ///< about its centre [kg m^2]
};
/// Spring and dashpot from a site to the ground, along a direction.
struct GroundSpring {
  Eigen::Vector3d direction;     ///< unit
  double stiffness = 0.0;        ///< [N/m]
  double damping = 0.0;          ///< [N s/m]
};
/// The same against rotation of the material at the site about an axis.
struct GroundTorsionSpring {
  Eigen::Vector3d axis;          ///< unit
  double stiffness = 0.0;        ///< [N m/rad]
  double damping = 0.0;          ///< [N m s/rad]
};
/// Spring between two sites along a direction (the line between them where it is zero).
struct LinkSpring {
  mesh::Site other;
  Eigen::Vector3d direction;
  double stiffness = 0.0, damping = 0.0;
};
/// A mass on a spring: brings one degree of freedom and one mode of its own.
struct Resonator {
  Eigen::Vector3d direction;     ///< unit
  double mass = 0.0;             ///< [kg]
  double stiffness = 0.0;        ///< [N/m]
  double damping = 0.0;          ///< [N s/m]
};

struct Attachment {
  std::string name;
  mesh::Site site;
  double footprint = 0.0;        ///< diameter over which it is spread evenly [m]; 0: a point
  std::variant<PointMass, GroundSpring, GroundTorsionSpring, LinkSpring, Resonator> what;
};

/// A patch whose nodes do not move along some axes.
struct Support {
  std::string patch;
  bool x = false, y = false, z = false;
};

}  // namespace chladni::fem
