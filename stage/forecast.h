// Number of modes and cost of a mesh, and refusal of impossible tasks before solving.
#pragma once

#include "stage/estimates/estimate.h"

namespace chladni::stage {

/// Number of modes below `hz` of a free body of this size and material, with rigid-body modes. It
/// is the sum for a thin plate that bends and moves in its plane and for a solid (Weyl's law:
/// Courant and Hilbert, VI.4; the rim's share is fitted to a square plate). For a slender body it
/// is the number of a beam that bends in both directions, if that is larger. Within a factor of 1.5
/// for ten modes or more.
[[nodiscard]] double modes_below(const Understood& body, double hz);

/// Number of flexible modes that a study without modes.up_to computes: modes.count, or more where a
/// higher one is expected.
[[nodiscard]] int wanted_count(const study::Study& study);

/// Number of modes that the study asks for, with the rigid-body ones; estimated for `up_to`.
[[nodiscard]] double modes_wanted(const study::Study& study, const Understood& body);

/// Warnings about flexible modes that a study with modes.up_to names by number, where about so many
/// cannot lie below that frequency: more than twice the number that modes_below tells.
[[nodiscard]] std::vector<std::string> unlikely_modes(const study::Study& study,
                                                      const Understood& body);

/// The `forecast` of a study with an existing mesh.
[[nodiscard]] Cost forecast(const study::Study& study, const mesh::TetMesh& mesh,
                            const Understood& body);

/// Frequency [Hz] below which about `flexible` modes of a free body lie: the inverse of
/// modes_below; 0 where the first frequency is not known.
[[nodiscard]] double frequency_of(double flexible, const Understood& body);

/// @throws InvalidInput  more modes below a frequency than the mesh can have
void refuse_too_many_modes(const study::Study& study, const Understood& body, const Cost& cost);

/// True where so much memory suffices. An estimate without a mesh is reduced first, because it is
/// right only to a third.
[[nodiscard]] bool fits(const Cost& cost, double have_bytes);

/// "0.52 GB", "140 MB".
[[nodiscard]] std::string bytes_text(double bytes);

}  // namespace chladni::stage
