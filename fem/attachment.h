// Attachments: masses, springs, dashpots, resonators and supports of a body.
#pragma once

#include <Eigen/SparseCore>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "mesh/site.h"

namespace chladni::fem {

/// A mass at a site. Its rotary inertia follows the rotation of the material at the site.
struct PointMass {
  double mass = 0.0;                                  ///< [kg]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about its centre [kg m^2]
};
/// Spring and dashpot from a site to the ground, along a direction.
struct GroundSpring {
  Eigen::Vector3d direction;  ///< unit
  double stiffness = 0.0;     ///< [N/m]
  double damping = 0.0;       ///< [N s/m]
};
/// Torsion spring and dashpot from a site to the ground, against rotation of the material at the
/// site about an axis.
struct GroundTorsionSpring {
  Eigen::Vector3d axis;    ///< unit
  double stiffness = 0.0;  ///< [N m/rad]
  double damping = 0.0;    ///< [N m s/rad]
};
/// Spring between two sites along a direction. A zero direction means the line between the sites.
struct LinkSpring {
  mesh::Site other;
  Eigen::Vector3d direction;
  double stiffness = 0.0, damping = 0.0;
};
/// A mass on a spring. It adds one degree of freedom and one mode.
struct Resonator {
  Eigen::Vector3d direction;  ///< unit
  double mass = 0.0;          ///< [kg]
  double stiffness = 0.0;     ///< [N/m]
  double damping = 0.0;       ///< [N s/m]
};

struct Attachment {
  std::string name;
  mesh::Site site;
  double footprint = 0.0;  ///< diameter of the disc over which it is spread [m]; 0: a point
  std::variant<PointMass, GroundSpring, GroundTorsionSpring, LinkSpring, Resonator> what;
};

/// A patch whose nodes do not move along some axes.
struct Support {
  std::string patch;
  bool x = false, y = false, z = false;
};

/// The terms that attachments add to the system, on all degrees of freedom: 3·node + axis for the
/// body's nodes, then the extra ones. Matrices are lower triangles (row >= column); entries with
/// the same row and column add up.
struct AttachmentTerms {
  /// A degree of freedom that an attachment brings: its displacement along `direction`.
  struct Extra {
    Eigen::Vector3d position;   ///< [m], for the rigid-body motions
    Eigen::Vector3d direction;  ///< unit
  };
  /// One spring, mass or dashpot on a linear form of the displacements, such as a stretch: it adds
  /// value · row rowᵀ.
  struct Form {
    std::vector<std::pair<Eigen::Index, double>> row;  ///< degree of freedom, factor
    double value = 0.0;  ///< [N/m] or [N m/rad] and so on; more than 0
  };
  /// Their sums are `stiffness`, `mass` and `damping`. Their number and order depend on the
  /// attachments alone, not on where the sites are.
  std::vector<Form> springs, masses, dashpots;
  std::vector<Eigen::Triplet<double>> stiffness;  ///< [N/m]
  std::vector<Eigen::Triplet<double>> mass;       ///< [kg]
  std::vector<Eigen::Triplet<double>> damping;    ///< [N s/m]
  std::vector<Extra> extras;
  [[nodiscard]] Eigen::Index extra_count() const {
    return static_cast<Eigen::Index>(extras.size());
  }
};

/// @throws InvalidInput  a mass, stiffness or damping is negative or not finite, a direction is not
///                       unit; names the attachment
[[nodiscard]] AttachmentTerms terms(const mesh::TetMesh& body,
                                    const std::vector<Attachment>& attachments);

/// The part of an attachment's footprint that lies on the body, 0 to 1; what is beyond an edge is
/// left out of it. 1 for a point. Cost: one pass over the boundary faces.
/// @param diameter  of the footprint [m]
[[nodiscard]] double footprint_on_body(const mesh::TetMesh& body, const mesh::Site& site,
                                       double diameter);

}  // namespace chladni::fem
