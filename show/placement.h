// Best places and layouts as text, JSON and files.
#pragma once

#include "show/run.h"
#include "steps/placement.h"

namespace chladni::app {

[[nodiscard]] io::JsonObject placement_json(const Study& study, const Solution& solution,
                                            const Placed& placed);

[[nodiscard]] std::string placement_table(const Solution& solution, const Placed& placed);

/// One line each, for the terminal.
[[nodiscard]] std::string optimum_text(const Optimum& optimum);

[[nodiscard]] std::string blind_text(const Solution& solution, const ScoredLayout& layout);

/// placement.json, heat_map.vtu, heat_map.png, layouts.png.
void leave_placement(const Study& study, const Solution& solution, const Placed& placed, Run& run,
                     bool main_result);

}  // namespace chladni::app
