// What a diagnosis tells of the constants that it calibrated.
#pragma once

#include <string>

#include "diagnosis/diagnosed.h"
#include "io/json.h"
#include "io/report.h"

namespace chladni::show {

/// A line for each constant: the study's value, the one found with its deviation, the change.
/// Empty: none was calibrated.
[[nodiscard]] std::string constants_text(const diagnosis::Diagnosis& result);
/// The number found beside the one of the study.
[[nodiscard]] io::JsonObject constant_json(const diagnosis::CalibratedNumber& number);
[[nodiscard]] io::JsonArray constants_json(const diagnosis::Diagnosis& result);
[[nodiscard]] io::Table constants_table(const diagnosis::Diagnosis& result);

}  // namespace chladni::show
