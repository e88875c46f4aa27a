// Errors of a simulation as text, pictures and JSON.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "diagnosis/compare.h"
#include "io/json.h"
#include "io/matrix_picture.h"
#include "io/picture_file.h"
#include "io/report.h"

namespace chladni::show {

/// Modes side by side, errors by band and by channel, and the most important findings.
[[nodiscard]] std::string comparison_table(const diagnosis::Comparison& comparison);

/// Additions to the table of paired modes, one line each: modes without a partner, poles that are
/// not modes, channels that cannot tell shapes apart.
[[nodiscard]] std::vector<std::string> unpaired_lines(const diagnosis::ModeComparison& modes);

/// comparison.json of responses. `discrepancy` of diagnosis.json has the misfit besides.
[[nodiscard]] io::JsonObject comparison_json(const diagnosis::Comparison& comparison);

/// Error, noise and likeness of each response, the sensors of the first actuator first.
[[nodiscard]] io::Json per_channel_json(const diagnosis::ResponseComparison& responses);

/// Measured responses with their 95 % band, the simulation and, if there is one, the extended
/// simulation. At most 24, those with the largest errors, in their original order.
/// @param before, after  [k], each p×q: arranged as measured.value; `after` may be empty
/// @param seen           true if a fit used the response of output i and input j; none: all
void draw_responses(const io::PictureFile& png, const modal::FrfSet& measured,
                    const std::vector<Eigen::MatrixXcd>& before,
                    const std::vector<Eigen::MatrixXcd>& after = {},
                    const std::function<bool(Eigen::Index i, Eigen::Index j)>& seen = {});

/// The same for the page, with phases and errors; those with the largest errors first.
/// @param bytes  as of response_curves
[[nodiscard]] io::Curves compared_responses(
    const modal::FrfSet& measured, const std::vector<Eigen::MatrixXcd>& before,
    const std::vector<Eigen::MatrixXcd>& after = {},
    const std::function<bool(Eigen::Index i, Eigen::Index j)>& seen = {},
    std::size_t bytes = 300'000);

/// The MAC of simulated against measured modes. Nothing if no mode was compared.
[[nodiscard]] io::MatrixPicture mac_picture(const diagnosis::Comparison& comparison);
void draw_mac(const io::PictureFile& png, const diagnosis::Comparison& comparison);

/// Error of each response: sensors × actuators. A response that was not measured has an empty
/// square; the largest known error is the darkest.
[[nodiscard]] io::MatrixPicture errors_picture(const diagnosis::Comparison& comparison);
void draw_errors(const io::PictureFile& png, const diagnosis::Comparison& comparison);

}  // namespace chladni::show
