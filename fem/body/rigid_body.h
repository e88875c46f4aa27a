// What a body does without bending: its rigid motions and its mass properties.
#pragma once

#include <vector>

#include "fem/attachment.h"
#include "fem/material.h"
#include "fem/system.h"
#include "mesh/tet_mesh.h"

namespace chladni::fem {

/// The motions of `system` that cost no energy, n×r, r between 0 and 6, mass-orthonormal:
/// translations along x, y, z, then rotations about the principal axes through the centre of mass
/// (where the body is partly held: what of these is left, orthonormalised in this order). They are
/// known from geometry: springs and supports are looked at, K is not.
[[nodiscard]] Eigen::MatrixXd rigid_motions(const mesh::TetMesh& body, const System& system,
                                            const AttachmentTerms& attachments);

/// The motions as a whole that supports let pass and springs resist, n×q, mass-orthonormal and
/// orthogonal to `system.rigid`, and the forces n×q that the springs answer with. The body itself
/// answers with none, which in floating point K does not know.
struct Suspension {
  Eigen::MatrixXd motions, forces;
};
[[nodiscard]] Suspension suspension(const mesh::TetMesh& body, const System& system,
                                    const AttachmentTerms& attachments);

/// 0.65 c t / L² of a plate of the body's volume, surface and extent [Hz]: where its first flexible
/// mode lies, to a factor of ten.
[[nodiscard]] double frequency_scale(const mesh::TetMesh& body,
                                     const std::vector<Material>& materials);

}  // namespace chladni::fem
