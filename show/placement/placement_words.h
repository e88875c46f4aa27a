// What the table, the JSON and the pictures of a placement share.
#pragma once

#include <string>

#include "steps/placement.h"

namespace chladni::show {

/// The first mode of a group of wanted modes.
[[nodiscard]] Eigen::Index column_of(const steps::BestPlaces& places, int group);

/// A score as an engineer reads it, with its unit.
[[nodiscard]] std::string value_text(const placement::Criterion& criterion, double score);

}  // namespace chladni::show
