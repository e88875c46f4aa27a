// What a fit leaves of its data, as text and as JSON.
#include <fmt/format.h>

#include <algorithm>

#include "show/identification.h"

namespace chladni::show {
namespace {

using identification::BandResidual;

std::string band_text(const BandResidual& band) {
  return fmt::format("{:.6g} to {:.6g} Hz", band.low_hz, band.high_hz);
}

const BandResidual* worst(const std::vector<BandResidual>& bands) {
  const auto found = std::ranges::max_element(bands, {}, &BandResidual::level);
  return found == bands.end() ? nullptr : &*found;
}

io::Json band_json(const BandResidual& band) {
  return io::JsonObject{{"low_hz", band.low_hz},
                        {"high_hz", band.high_hz},
                        {"lines", static_cast<long long>(band.lines)},
                        {"relative_error", band.relative_error},
                        {"residual_over_noise", band.level},
                        {"residual_over_noise_std", band.level_deviation},
                        {"correlation", band.correlation},
                        {"correlation_limit", band.correlation_limit}};
}

}  // namespace

std::string validation_text(const steps::IdentifiedModel& model) {
  const auto& [percent_of, percent, whole, bands] = model.validation;
  std::string text =
      fmt::format("fit {:.4g} %; the residual's square is {:.3g} times the {}", percent,
                  whole.level, model.data.noise_known ? "noise" : "noise and model error allowed");
  const auto* most = worst(bands);
  if (bands.size() > 1) {
    text += fmt::format(", {:.3g} times at most ({})", most->level, band_text(*most));
  }
  const bool is_white = std::abs(whole.correlation) <= whole.correlation_limit;
  return text + fmt::format("; from line to line it is {} ({:.2f}, noise to {:.2f})\n",
                            is_white ? "white" : "correlated", whole.correlation,
                            whole.correlation_limit);
}

io::Json validation_json(const steps::IdentifiedModel& model) {
  const auto& validation = model.validation;
  io::JsonArray bands;
  for (const auto& band : validation.bands) bands.push_back(band_json(band));
  return io::JsonObject{{"fit_percent", validation.fit_percent},
                        {"fit_percent_of_responses", io::Json::rows(validation.fit_percent_of)},
                        {"whole", band_json(validation.whole)},
                        {"bands", bands}};
}

}  // namespace chladni::show
