// Whether a cause that explains modal data differs from what a sound structure has.
#pragma once

#include <cstddef>

#include "diagnosis/modes/modes_fit.h"

namespace chladni::diagnosis {

/// The deviation that a size is compared with, where extent and other forms of the cause are as
/// they are. A mass on a node of a mode may be known by its effect and not by its size: what it
/// changes is certain, and so is that it is there.
enum class SizeDeviation {
  in_place,  ///< where the place is as it is, too
  anywhere,  ///< wherever it is: what a search asks of a cause that it tells
};

/// True if a size of cause `which` differs from that of a sound structure by more than
/// Constants::significant deviations, and by more than such structures differ. The size of a cause
/// without a strength is its frequency; a cause without both is there or not. Anywhere, a known
/// frequency is enough: a light thing that rings is heard before it is weighed.
/// @param fit  with its covariance
[[nodiscard]] bool is_significant(const ModesProblem& problem, const ModesFit& fit,
                                  std::size_t which, SizeDeviation by);

/// True if all causes of a fit are significant wherever they are. A size that is not known, a mass
/// of -1.6 +- 0.9 g, is not named: what no catalogue has may be there as well.
[[nodiscard]] bool have_clear_sizes(const ModesProblem& problem, const ModesFit& fit);

}  // namespace chladni::diagnosis
