// What is wrong with a simulation, told, drawn and kept.
#pragma once

#include <filesystem>
#include <string>

#include "diagnosis/compare.h"
#include "io/json.h"

namespace chladni::app {

/// Modes beside each other, errors by band and by channel, what of it stands out.
[[nodiscard]] std::string comparison_table(const diagnosis::Comparison& comparison);

/// `discrepancy` of diagnosis.json.
[[nodiscard]] io::JsonObject comparison_json(const diagnosis::Comparison& comparison);

/// Measured responses with their 95 % band, the simulation over them and, where there is one, the
/// extended simulation; 24 at most: the ones that were most wrong, in their order.
/// @param before, after  [k], each p×q: as measured.value; `after` may be empty
void draw_responses(const std::filesystem::path& png, const modal::FrfSet& measured,
                    const std::vector<Eigen::MatrixXcd>& before,
                    const std::vector<Eigen::MatrixXcd>& after = {});

/// The MAC of simulated against measured modes. Nothing where no mode was compared.
void draw_mac(const std::filesystem::path& png, const diagnosis::Comparison& comparison);

/// How wrong each response is: sensors × actuators.
void draw_errors(const std::filesystem::path& png, const diagnosis::Comparison& comparison);

}  // namespace chladni::app
