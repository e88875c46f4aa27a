// Modes of a body that is its own mirror image, found in classes of symmetry.
#pragma once

#include <vector>

#include "fem/attachment.h"
#include "fem/modes.h"

namespace chladni::fem {

/// A mirror plane of a system, through the middle of its body. A displacement u becomes u' with
/// u'(image(i)) = sign(i) u(i), and K and M stay as they are.
struct Mirror {
  int axis = 0;           ///< 0, 1, 2: x, y or z changes its sign
  Eigen::VectorXi image;  ///< n: the degree of freedom that takes the place of each
  Eigen::VectorXd sign;   ///< n: ±1
};

/// The mirror plane across `axis`. That it is one is shown by K and M themselves: every entry
/// equals that of its image, to 1e-9 of the diagonal.
/// @param attachments  of the system, for the directions of resonators and for messages
/// @throws InvalidInput  a node, a support, a resonator or an entry of K or M has no equal image
///                       (says where, and which attachment is nearest)
/// Cost: n log n, and a search per entry of K and M.
[[nodiscard]] Mirror mirror_of(const mesh::TetMesh& body,
                               const std::vector<Attachment>& attachments, const System& system,
                               int axis);

/// The modes as `modes` finds them, from smaller systems. Every mode of a mirrored body can be
/// chosen even or odd about each plane, so K and M fall into 2^p blocks of about n / 2^p degrees of
/// freedom for p planes (Bossavit 1986, Comput. Methods Appl. Mech. Eng. 56, 167-215). Each block
/// is solved and counted by `modes`, one after the other. On the whole K and M the shapes then have
/// Rayleigh-Ritz in extended precision, and the residuals are computed there. The certificate is
/// the sum of the counts. Repeated modes and signs are as in `modes`.
///
/// @param mirrors  one to three, of `system`
/// @throws InvalidInput     no mirrors, or as `modes`
/// @throws FactorTooLarge   a block does not fit
/// @throws NumericalFailure, Interrupted  as `modes`
[[nodiscard]] ModesResult modes_by_mirrors(const System& system, const std::vector<Mirror>& mirrors,
                                           const ModesOptions& options = {},
                                           const Progress& progress = {});

/// As memory_forecast of fem/modes.h, of the largest block with all shapes.
[[nodiscard]] MemoryForecast memory_forecast(const System& system,
                                             const std::vector<Mirror>& mirrors,
                                             const ModesOptions& options);

}  // namespace chladni::fem
