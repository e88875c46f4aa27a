// What is wrong with a simulation, told, drawn and kept.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "diagnosis/compare.h"
#include "io/json.h"
#include "io/matrix_picture.h"

namespace chladni::app {

/// Modes beside each other, errors by band and by channel, what of it stands out.
[[nodiscard]] std::string comparison_table(const diagnosis::Comparison& comparison);

/// What the table of paired modes leaves out, a line each: modes without a partner, poles that are
/// no modes, channels that do not tell shapes apart.
[[nodiscard]] std::vector<std::string> unpaired_lines(const diagnosis::ModeComparison& modes);

/// `discrepancy` of diagnosis.json.
[[nodiscard]] io::JsonObject comparison_json(const diagnosis::Comparison& comparison);

/// Measured responses with their 95 % band, the simulation over them and, where there is one, the
/// extended simulation; 24 at most: the ones that were most wrong, in their order.
/// @param before, after  [k], each p×q: as measured.value; `after` may be empty
/// @param seen           whether a fit saw the responses of output i and input j; none: all
void draw_responses(const std::filesystem::path& png, const modal::FrfSet& measured,
                    const std::vector<Eigen::MatrixXcd>& before,
                    const std::vector<Eigen::MatrixXcd>& after = {},
                    const std::function<bool(Eigen::Index i, Eigen::Index j)>& seen = {});

/// The MAC of simulated against measured modes. Nothing where no mode was compared.
void draw_mac(const std::filesystem::path& png, const diagnosis::Comparison& comparison);

/// How wrong each response is: sensors × actuators. Of a response that was not measured nothing is
/// known: its square stays empty, and the largest error that is known is the darkest.
[[nodiscard]] io::MatrixPicture errors_picture(const diagnosis::Comparison& comparison);
void draw_errors(const std::filesystem::path& png, const diagnosis::Comparison& comparison);

}  // namespace chladni::app
