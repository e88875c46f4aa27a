// A diagnosis of several specimens as text and JSON.
#pragma once

#include <string>

#include "io/json.h"
#include "show/run.h"
#include "steps/specimens.h"

namespace chladni::show {

/// "thickness of 1L: 4.520 +- 0.050 mm, written 4.800 (-5.8 %)"
[[nodiscard]] std::string entry_text(const diagnosis::OddEntry& entry);

/// The verdict in a sentence.
[[nodiscard]] std::string verdict_text(const diagnosis::SpecimensDiagnosis& result);

/// Verdict, entries, and a table: a line for each constant and entry, a column for each specimen.
[[nodiscard]] std::string specimens_table(const diagnosis::SpecimensDiagnosis& result);

[[nodiscard]] io::JsonObject specimens_json(const diagnosis::SpecimensDiagnosis& result);

/// diagnosis.json
void leave_specimens(const steps::DiagnosedSpecimens& diagnosed, Run& run);

}  // namespace chladni::show
