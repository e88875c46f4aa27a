// Interpolated shapes and predicted responses as text, JSON, pictures and files.
#pragma once

#include "io/picture_file.h"
#include "show/run.h"
#include "steps/interpolation.h"

namespace chladni::show {

/// At most 24 predicted responses, over the measured ones.
/// @param predicted  with variances
void draw_predictions(const steps::IdentifiedModel& model, const modal::FrfSet& predicted,
                      const io::PictureFile& png);

/// Name of the picture: predicted.png for predicted.csv.
[[nodiscard]] std::string predictions_picture(const std::string& file);

/// Writes `file` (predicted.csv), predicted_band.csv (with variances) on the lines of the file,
/// predicted.png and spatio_temporal.mat: receptances at the sensors outside the fit and at the
/// points of interest.
void leave_predictions(const steps::Interpolated& result, const std::string& file, Run& run);

[[nodiscard]] io::JsonObject interpolation_json(const steps::Interpolated& result);

[[nodiscard]] std::string interpolation_table(const steps::Interpolated& result);

/// interpolation.json, mode_field.vtu, mode_field.png, and on request mode_field.csv (a lookup
/// table) and mode_field_polynomial.json.
void leave_interpolation(const study::Study& study, const stage::Solution& solution,
                         const steps::Interpolated& result, Run& run, bool main_result);

}  // namespace chladni::show
