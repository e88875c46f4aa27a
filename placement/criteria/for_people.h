// Scores of criteria as an engineer reads them.
#pragma once

namespace chladni::placement {

[[nodiscard]] inline double unchanged(double score) { return score; }
/// The score is one over a relative deviation; the result is that deviation in %.
[[nodiscard]] inline double deviation_percent(double score) { return 100.0 / score; }

}  // namespace chladni::placement
