// Motions of a body without bending: rigid motions and motions that only springs resist.
#pragma once

#include <vector>

#include "fem/attachment.h"
#include "fem/material.h"
#include "fem/system.h"
#include "mesh/tet_mesh.h"

namespace chladni::fem {

/// The motions of `system` that cost no energy, n×r, r between 0 and 6, mass-orthonormal:
/// translations along x, y, z, then rotations about the principal axes through the centre of mass.
/// Where the body is partly held, the remaining motions are orthonormalised in this order. The
/// motions are computed from the geometry, the springs and the supports, not from K.
[[nodiscard]] Eigen::MatrixXd rigid_motions(const mesh::TetMesh& body, const System& system,
                                            const AttachmentTerms& attachments);

/// The motions of the whole body that no support blocks and that springs resist, n×q,
/// mass-orthonormal and orthogonal to `system.rigid`, and the spring forces n×q on these motions.
/// The body itself resists none of these motions, but the rounding errors in K would add a
/// resistance.
struct Suspension {
  Eigen::MatrixXd motions, forces;
};
[[nodiscard]] Suspension suspension(const mesh::TetMesh& body, const System& system,
                                    const AttachmentTerms& attachments);

/// 0.65 c t / L² of a plate with the body's volume, surface and extent, and with the mean stiffness
/// and density of its cells [Hz]. This estimates the first flexible frequency to a factor of ten.
[[nodiscard]] double frequency_scale(const mesh::TetMesh& body,
                                     const std::vector<Material>& materials);

}  // namespace chladni::fem
