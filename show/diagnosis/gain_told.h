// What naming the causes gains, as text, table and JSON.
#pragma once

#include <string>
#include <vector>

#include "io/json.h"
#include "io/result_table.h"
#include "steps/diagnosis.h"

namespace chladni::show {

/// Relative errors of the predicted responses before and after, and the noise: fitted, held out,
/// and each kind of parts that were held out in turn.
[[nodiscard]] io::ResultTable gain_table(const steps::Diagnosed& one);
/// The table, and the lines below it.
[[nodiscard]] std::string gain_text(const steps::Diagnosed& one);
/// Origin of the responses after the diagnosis, and what held-out data say; one line each.
[[nodiscard]] std::vector<std::string> gain_lines(const steps::Diagnosed& one);
/// `gain` of diagnosis.json.
[[nodiscard]] io::JsonObject gain_json(const steps::Diagnosed& one);

}  // namespace chladni::show
