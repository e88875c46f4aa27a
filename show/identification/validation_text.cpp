// What a fit leaves of its data, as text and as JSON.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "identification/constants.h"
#include "show/identification.h"
#include "show/readable.h"

namespace chladni::show {
namespace {

using identification::BandResidual;

std::string band_text(const BandResidual& band) {
  return fmt::format("{:.6g} to {:.6g} Hz", band.low_hz, band.high_hz);
}

// The band that leaves most. Bands without a measured line have no level; none if all are such.
const BandResidual* worst(const std::vector<BandResidual>& bands) {
  const BandResidual* found = nullptr;
  for (const auto& band : bands) {
    if (std::isfinite(band.level) && (!found || band.level > found->level)) found = &band;
  }
  return found;
}

io::Json band_json(const BandResidual& band) {
  return io::JsonObject{{"low_hz", band.low_hz},
                        {"high_hz", band.high_hz},
                        {"lines", static_cast<long long>(band.lines)},
                        {"relative_error", band.relative_error},
                        {"noise_floor", band.relative_noise},
                        {"residual_over_noise", band.level},
                        {"residual_over_noise_std", band.level_deviation},
                        {"correlation", band.correlation},
                        {"correlation_limit", band.correlation_limit}};
}

// "predicted to 2.31 % of their size, noise there 2.28 %; the error's square is 1.02 +- 0.03 times
// the noise, 1.01 if the model is right"
std::string prediction_text(const identification::Validation& left, double expected,
                            bool noise_known, bool freedom_known) {
  constexpr double kNoChance = 3.0;
  // What variances of an unknown number of averages may leave of noise alone.
  const double noise = freedom_known ? 1.0 : identification::Constants::good_level;
  const auto& whole = left.whole;
  std::string text = fmt::format(
      "predicted to {:.3g} % of their size, {} there {}; the error's square is {:.4g} +- "
      "{} times that, {:.4g} of a right model",
      100.0 * whole.relative_error, noise_known ? "noise" : "noise and model error allowed",
      std::isfinite(whole.relative_noise) ? fmt::format("{:.3g} %", 100.0 * whole.relative_noise)
                                          : "not known",
      whole.level, deviation_text(whole.level_deviation), expected);
  const auto* most = worst(left.bands);
  if (most && left.bands.size() > 1) {
    text += fmt::format(", {:.3g} times at most ({})", most->level, band_text(*most));
  }
  const bool is_more = whole.level > noise * expected + kNoChance * whole.level_deviation;
  return text + (is_more ? ": the model lacks or invents something\n" : "\n");
}

io::JsonArray bands_json(const std::vector<BandResidual>& bands) {
  io::JsonArray array;
  for (const auto& band : bands) array.push_back(band_json(band));
  return array;
}

io::Json cross_validation_json(const steps::IdentifiedModel& model) {
  if (!model.cross_validation) return {};
  const auto& found = *model.cross_validation;
  io::JsonArray parts;
  for (const auto& part : found.parts) {
    parts.push_back(io::JsonObject{{"name", part.name}, {"whole", band_json(part.whole)}});
  }
  return io::JsonObject{{"by", found.by},
                        {"whole", band_json(found.all.whole)},
                        {"expected", found.expected_level},
                        {"bands", bands_json(found.all.bands)},
                        {"parts", parts}};
}

io::Json second_record_json(const steps::IdentifiedModel& model) {
  if (!model.second_record) return {};
  const auto& second = *model.second_record;
  return io::JsonObject{{"file", std::filesystem::path(second.file).filename().string()},
                        {"noise_known", second.noise_known},
                        {"fit_percent", second.left.fit_percent},
                        {"fit_percent_of_responses", io::Json::rows(second.left.fit_percent_of)},
                        {"whole", band_json(second.left.whole)},
                        {"expected", second.expected_level},
                        {"bands", bands_json(second.left.bands)}};
}

}  // namespace

std::string unseen_text(const steps::IdentifiedModel& model) {
  std::string text;
  if (const auto& left_out = model.cross_validation) {
    text += fmt::format("{} left out in turn ({}): {}", left_out->by, left_out->parts.size(),
                        prediction_text(left_out->all, left_out->expected_level,
                                        model.data.noise_known, model.data.freedom_known));
  }
  if (const auto& second = model.second_record) {
    text +=
        fmt::format("second record {}: {}", std::filesystem::path(second->file).filename().string(),
                    prediction_text(second->left, second->expected_level, second->noise_known,
                                    second->freedom_known));
  }
  return text;
}

std::string validation_text(const steps::IdentifiedModel& model) {
  const auto& [percent_of, percent, whole, bands] = model.validation;
  std::string text =
      fmt::format("fit {:.4g} %; the residual's square is {:.3g} times the {}", percent,
                  whole.level, model.data.noise_known ? "noise" : "noise and model error allowed");
  const auto* most = worst(bands);
  if (most && bands.size() > 1) {
    text += fmt::format(", {:.3g} times at most ({})", most->level, band_text(*most));
  }
  const bool is_white = std::abs(whole.correlation) <= whole.correlation_limit;
  text +=
      fmt::format("; from line to line it is {} ({:.2f}, noise to {:.2f})\n",
                  is_white ? "white" : "correlated", whole.correlation, whole.correlation_limit);
  return text + unseen_text(model);
}

io::Json validation_json(const steps::IdentifiedModel& model) {
  const auto& validation = model.validation;
  return io::JsonObject{{"fit_percent", validation.fit_percent},
                        {"fit_percent_of_responses", io::Json::rows(validation.fit_percent_of)},
                        {"whole", band_json(validation.whole)},
                        {"bands", bands_json(validation.bands)},
                        {"cross_validation", cross_validation_json(model)},
                        {"second_record", second_record_json(model)}};
}

}  // namespace chladni::show
