// Curves of responses that verbs leave for figures.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "io/curves.h"
#include "io/json.h"
#include "show/run.h"

namespace chladni::show {

/// Room for the curves of one file: about 24 responses of 1500 lines.
inline constexpr std::size_t kStoredCurvesBytes = 600'000;

/// The curves in seven digits, over one grid of frequencies.
/// @throws InvalidInput  they have several grids, or a choice lacks an array
[[nodiscard]] io::JsonObject curves_json(const io::Curves& curves);

/// @throws InvalidInput  the file has other content than curves_json gives
[[nodiscard]] io::Curves stored_curves(const io::Json& content);

/// Leaves the curves of a picture as JSON, where pictures are painted; nothing where there are none
/// (InvalidInput of `curves`).
void leave_curves(Run& run, const std::string& file, const std::function<io::Curves()>& curves);

/// The magnitudes of the first six responses, which were missed most, each with its band.
[[nodiscard]] io::Plot magnitudes_plot(const io::Curves& curves);

/// Magnitude above phase of one response.
/// @param pair  "sensor/actuator"
/// @throws InvalidInput  it is not stored (names those that are)
[[nodiscard]] io::Plot response_plot(const io::Curves& curves, std::string_view pair);

}  // namespace chladni::show
