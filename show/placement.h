// Best places and layouts as text, JSON and files.
#pragma once

#include "io/result_table.h"
#include "show/run.h"
#include "steps/placement.h"

namespace chladni::show {

[[nodiscard]] io::JsonObject placement_json(const study::Study& study,
                                            const stage::Solution& solution,
                                            const steps::BestPlaces& places);

/// The best places, then the layouts.
/// @param all  false: of the layouts' criteria only those by which a layout was chosen
[[nodiscard]] std::string placement_table(const stage::Solution& solution,
                                          const steps::BestPlaces& places, bool all = true);

/// Best pairs, best first.
[[nodiscard]] io::ResultTable pairs_table(const stage::Solution& solution,
                                          const steps::BestPlaces& places,
                                          const std::vector<placement::BestPair>& pairs);

/// One line each, for the terminal.
[[nodiscard]] std::string optimum_text(const placement::Optimum& optimum);

[[nodiscard]] std::string blind_text(const stage::Solution& solution,
                                     const steps::ScoredLayout& layout);

/// placement.json, heat_map.vtu, heat_map.png, layouts.png; observer_layouts.png where an observer
/// is placed for.
void leave_placement(const study::Study& study, const stage::Solution& solution,
                     const steps::BestPlaces& places, Run& run, bool main_result);

}  // namespace chladni::show
