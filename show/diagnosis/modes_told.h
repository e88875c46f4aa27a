// What a diagnosis of modes tells: levels of the model's errors, and modes before and after.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/diagnosed.h"
#include "io/json.h"
#include "io/result_table.h"

namespace chladni::show {

/// "The model's frequencies are good to 0.8 %, its shapes to 5 %." Empty: the levels are known.
[[nodiscard]] std::string levels_sentence(const diagnosis::Diagnosis& result);
/// Each class with its levels before and after, what is usual, and what is believed at most.
[[nodiscard]] io::JsonObject levels_json(const diagnosis::Diagnosis& result);
/// Proposals of further measurements, best first: what, of, place_m, mass_kg, log_evidence, cost.
[[nodiscard]] io::JsonArray proposals_json(const std::vector<diagnosis::Proposal>& proposals);

/// True if the best explanation changes the simulation: by causes, or by calibrated constants.
[[nodiscard]] inline bool changes_modes(const diagnosis::Diagnosis& result) {
  return !result.best.causes.empty() || !result.constants.empty();
}

/// True if measured modes were compared with those of a reference.
[[nodiscard]] bool has_reference(const diagnosis::Diagnosis& result);
/// "compared with before.csv: 12 of 13 modes are in both". Empty: there is no reference.
[[nodiscard]] std::string reference_line(const diagnosis::Diagnosis& result,
                                         const std::string& file);

/// Measured modes beside those before and after; their JSON has all columns.
/// @param has_causes  the text and the report have the columns after the causes
[[nodiscard]] io::ResultTable modes_told_table(const std::vector<diagnosis::ModeTold>& modes,
                                               bool has_causes);
/// The same as text; empty: none are told.
[[nodiscard]] std::string modes_told_text(const std::vector<diagnosis::ModeTold>& modes,
                                          bool has_causes);

}  // namespace chladni::show
