// An identified model as text, JSON, pictures and files.
#pragma once

#include <optional>

#include "io/picture_file.h"
#include "io/report.h"
#include "io/result_table.h"
#include "io/shape_table.h"
#include "show/run.h"
#include "steps/identification.h"

namespace chladni::show {

/// The modes with their standard deviations and gains.
[[nodiscard]] io::ResultTable identified_modes_table(const steps::IdentifiedModel& model);
[[nodiscard]] std::string identification_table(const steps::IdentifiedModel& model);
/// The table, then the body as a whole and its decoupling, where the channels tell them.
[[nodiscard]] std::string identification_text(const study::Study& study,
                                              const steps::IdentifiedModel& model);
/// "noise 0.42 %", with the error that the model may have where that is part of it; or that it is
/// not known.
[[nodiscard]] std::string noise_text(const steps::IdentifiedModel& model);

/// "trust: ...", then a line for each doubtful mode and outlying line.
[[nodiscard]] std::string trust_text(const steps::IdentifiedModel& model);
[[nodiscard]] io::Json trust_json(const steps::IdentifiedModel& model);

/// Fit in per cent, residual over noise, the band where it is largest, and whether it is white;
/// then how well unseen data are predicted, where there are any.
[[nodiscard]] std::string validation_text(const steps::IdentifiedModel& model);
[[nodiscard]] io::Json validation_json(const steps::IdentifiedModel& model);
/// The sentences about data that the fit has not seen; empty where there are none.
[[nodiscard]] std::string unseen_text(const steps::IdentifiedModel& model);

/// How good recordings are, in which band, and what was done to them; empty or null for responses.
[[nodiscard]] std::string quality_text(const steps::IdentifiedModel& model);
[[nodiscard]] io::Json quality_json(const steps::IdentifiedModel& model);
[[nodiscard]] std::optional<io::ResultTable> quality_table(const steps::IdentifiedModel& model);
/// detection_lines.csv, where there are lines that nothing excites.
void leave_detection_lines(const steps::IdentifiedModel& model, Run& run);

/// identified.json without its head
[[nodiscard]] io::JsonObject identified_json(const study::Study& study,
                                             const steps::IdentifiedModel& model);

/// identified_shapes.csv: the modes within the lines at all channels in one scale. A value whose
/// deviation is not known is NaN, an empty cell in the file: a table of shapes has no other word
/// for what is not known.
[[nodiscard]] io::ShapeTable identified_shapes(const steps::IdentifiedModel& model);

/// Magnitudes of at most 24 responses: measured, fitted and residual; NaN where not measured.
[[nodiscard]] io::Plot fit_plot(const steps::IdentifiedModel& model);
void draw_fit(const steps::IdentifiedModel& model, const io::PictureFile& png);

/// The same for the page, with phases and errors.
/// @param bytes  as of response_curves
[[nodiscard]] io::Curves fitted_curves(const steps::IdentifiedModel& model,
                                       std::size_t bytes = 300'000);

/// Poles of rising order; the modes of the fit are dashed. The picture has the mode indicator
/// beneath, where there are several channels on both sides.
[[nodiscard]] io::Plot stabilisation_plot(const steps::IdentifiedModel& model);
void draw_stabilisation(const steps::IdentifiedModel& model, const io::PictureFile& png);

/// identified.json, identified.mat (all places), identified_shapes.csv, the files of
/// leave_control_models, fit.png with fit_curves.json and, where it was asked for,
/// stabilisation.png
void leave_identification(const study::Study& study, const steps::IdentifiedModel& model, Run& run,
                          bool main_result);

/// Shows the table and leaves the files as soon as a model is fitted: for `interpolated`.
[[nodiscard]] std::function<void(const steps::IdentifiedModel&)> shown_and_left(
    const study::Study& study, Run& run);

}  // namespace chladni::show
