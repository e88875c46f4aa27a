// How many modes there will be, what a mesh will cost, and what is refused before it is solved.
#pragma once

#include "app/stage/estimate.h"

namespace chladni::app {

/// How many modes a free body of this size and material has below `hz`, rigid-body ones included:
/// those of a thin plate that bends and moves in its plane, and of a solid (Weyl's law: Courant and
/// Hilbert, VI.4; the rim's share is fitted to a square plate), added; of a slender one those of a
/// beam that bends both ways where these are more. Within a factor of 1.5 from ten modes on.
[[nodiscard]] double modes_below(const Understood& body, const fem::Material& material, double hz);

/// The modes that the study asks for, with the rigid-body ones; those of `up_to` estimated.
[[nodiscard]] double modes_wanted(const Study& study, const Understood& body);

/// `forecast` of a study whose mesh is there.
[[nodiscard]] Cost forecast(const Study& study, const mesh::TetMesh& mesh, const Understood& body);

/// @throws InvalidInput    more modes are asked for below a frequency than the mesh can have
/// @throws OutOfResources  it needs more memory than there is; of a guess, that is good to a third,
///                         less is believed
void refuse_what_cannot_fit(const Study& study, const Understood& body, const Cost& cost);

}  // namespace chladni::app
