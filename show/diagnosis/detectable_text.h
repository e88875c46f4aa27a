// Detectable effects of an experiment, as text and as JSON.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/detectable.h"
#include "io/json.h"
#include "io/report.h"
#include "steps/diagnosis.h"

namespace chladni::show {

/// "This experiment finds, 99 times in 100: point_mass of 1 g to 8.1 g, ..."; empty if it finds
/// none of the usual effects. Effects without numbers whose evidence is below `least_evidence`
/// (DiagnosisPlan) are listed as possible misses.
[[nodiscard]] std::string detectable_sentence(const std::vector<diagnosis::Detectable>& all,
                                              double least_evidence);

/// A line per effect: best, median and worst.
[[nodiscard]] std::string detectable_table(const std::vector<diagnosis::Detectable>& all,
                                           double least_evidence);
/// The same as a table of the report, with the place of the worst.
[[nodiscard]] io::Table detectable_sizes(const std::vector<diagnosis::Detectable>& all);

/// Entries {effect, of, parameter, size, unit, found, channels, option, place_m, frequency_hz,
/// log_evidence}; `found` is "above" or "below" the size. Null if no size is large enough, and for
/// effects without numbers, which have only an evidence.
[[nodiscard]] io::JsonArray detectable_json(const std::vector<diagnosis::Detectable>& all);

/// The sentence of a diagnosis; empty where its modes answer: these sizes are those that responses
/// show, which such a model does not explain.
[[nodiscard]] std::string detectable_sentence(const steps::Diagnosed& one);

}  // namespace chladni::show
