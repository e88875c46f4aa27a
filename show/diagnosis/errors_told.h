// The errors of a simulation over frequency and over the body.
#pragma once

#include <string>

#include "io/json.h"
#include "io/picture_file.h"
#include "io/result_table.h"
#include "steps/diagnosis.h"

namespace chladni::show {

/// Relative errors before and after, over the lines, above the band of noise and of the errors that
/// a sound model has. Nothing if there are no errors.
void draw_errors_over_frequency(const io::PictureFile& png,
                                const steps::ErrorsOverFrequency& errors);

/// The same in Constants::bands bands of as many lines: root mean squares.
[[nodiscard]] io::ResultTable errors_table(const steps::ErrorsOverFrequency& errors);

/// `errors_over_frequency` of diagnosis.json.
[[nodiscard]] io::JsonObject errors_json(const steps::ErrorsOverFrequency& errors);

/// "The error lives most at (120.0, 80.0) mm: one thing there would explain 91 % of it." Empty
/// without a map.
[[nodiscard]] std::string place_of_error(const steps::Diagnosed& one);
/// `error_on_body` of diagnosis.json: the best place of the map, and all of them. Null: no map.
[[nodiscard]] io::Json error_on_body_json(const steps::Diagnosed& one);

}  // namespace chladni::show
