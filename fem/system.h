// The structure M ü + C u̇ + K u = f that the assembler returns.
#pragma once

#include <memory>

#include "base/arrays.h"
#include "fem/factor/kept_factor.h"

namespace chladni::fem {

/// Says which rows of a field on the mesh's nodes (x0 y0 z0 x1 ..., then the degrees of freedom
/// that attachments add) are free to move.
struct DofMap {
  Eigen::VectorXi free_dof;     ///< 3 nodes + extra: row in the system, or −1 where it is held
  Eigen::Index free_count = 0;  ///< n
  Eigen::Index node_count = 0;
  [[nodiscard]] Eigen::Index extra_count() const { return free_dof.size() - 3 * node_count; }
};

/// n free degrees of freedom.
struct System {
  SparseMatrix stiffness;     ///< K, n×n [N/m], lower triangle, positive semidefinite
  SparseMatrix mass;          ///< M, n×n [kg], lower triangle, positive definite
  SparseMatrix damping;       ///< C, n×n [N s/m], lower triangle; empty where there is no damper
  Eigen::MatrixXd rigid;      ///< n×r: the motions that cost no energy, mass-orthonormal;
                              ///< translations along x, y, z first, then rotations about the
                              ///< principal axes
  Eigen::MatrixXd suspended;  ///< n×q: the motions of the whole body that only springs resist,
                              ///< mass-orthonormal and orthogonal to the rigid ones; may be empty
  Eigen::MatrixXd suspension_force;  ///< n×q: K times `suspended`, from the springs alone [N]
  Points positions;                  ///< n×3 [m]: where each degree of freedom is; may be empty
  DofMap dofs;
  double frequency_scale_hz = 0.0;  ///< first flexible frequency to a factor of 10; 0: not known
  /// What `modes` and `reduced` leave for each other; a copy of the system shares it.
  std::shared_ptr<KeptFactor> kept_factor = std::make_shared<KeptFactor>();
};

/// Mass, centre and inertia of a body with all that is attached to it.
struct MassProperties {
  double mass_kg = 0.0;
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();  ///< about the centre, axes of the body
};

/// Expands a field on the free degrees of freedom to all nodes (3·node_count rows). Held degrees of
/// freedom become 0; extra ones are left out.
[[nodiscard]] Eigen::MatrixXd on_nodes(const DofMap& dofs, const Eigen::MatrixXd& free);

}  // namespace chladni::fem
