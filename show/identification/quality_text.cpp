// The quality of recordings, as text, JSON and a table of the lines that nothing excites.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "io/csv.h"
#include "show/identification.h"

namespace chladni::show {
namespace {

using recordings::DataQuality;

// "distortion below the response: even 62.1 dB, odd 48.3 dB; noise 70.2 dB"
std::string detection_text(const DataQuality& quality) {
  if (!quality.detection) return "";
  const auto& levels = *quality.detection;
  const auto below = [](double decibels, double noise) {
    if (std::isnan(decibels)) return std::string("not looked for");
    return decibels < noise ? std::string("below the noise") : fmt::format("{:.1f} dB", decibels);
  };
  std::string text;
  for (std::size_t i = 0; i < quality.outputs.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    text += fmt::format("  {} on lines that nothing excites: even {}, odd {}, noise {}\n",
                        quality.outputs[i], below(levels.even_db(at), levels.noise_db(at)),
                        below(levels.odd_db(at), levels.noise_db(at)),
                        fmt::format("{:.1f} dB", levels.noise_db(at)));
  }
  return text;
}

io::Json bands_json(const DataQuality& quality) {
  io::JsonArray array;
  for (const auto& band : quality.bands) {
    array.push_back(io::JsonObject{{"band_hz", io::JsonArray{band.low_hz, band.high_hz}},
                                   {"lines", static_cast<long long>(band.lines)},
                                   {"deviation", io::Json(band.deviation)},
                                   {"variance_over_noise", io::Json(band.distortion)}});
  }
  return array;
}

io::Json drift_json(const DataQuality& quality) {
  io::JsonArray array;
  for (const auto& drift : quality.drift) {
    array.push_back(
        io::JsonObject{{"sensor", quality.outputs[static_cast<std::size_t>(drift.output)]},
                       {"relative", drift.relative},
                       {"excess", drift.excess}});
  }
  return array;
}

io::ResultTable bands_table(const DataQuality& quality) {
  const auto n = std::ssize(quality.bands);
  Eigen::VectorXd low(n), high(n), deviation(n), distortion(n);
  std::vector<std::string> worst;
  for (Eigen::Index b = 0; b < n; ++b) {
    const auto& band = quality.bands[static_cast<std::size_t>(b)];
    Eigen::Index at = 0;
    low(b) = band.low_hz;
    high(b) = band.high_hz;
    deviation(b) = band.deviation.maxCoeff(&at);
    distortion(b) = band.distortion(at);
    worst.push_back(quality.responses[static_cast<std::size_t>(at)]);
  }
  io::ResultTable table{"Quality of the recordings, by band", {}};
  table.columns = {io::number_column("from", "Hz", low, {"{:.4g}"}, 10),
                   io::number_column("to", "Hz", high, {"{:.4g}"}, 10),
                   io::number_column("deviation", "%", deviation, {"{:.2g}", 100.0}, 10),
                   io::number_column("variance/noise", "", distortion, {"{:.3g}"}, 15),
                   io::word_column("worst response", worst)};
  return table;
}

}  // namespace

std::string quality_text(const steps::IdentifiedModel& model) {
  if (!model.measured.quality) return "";
  const auto& quality = *model.measured.quality;
  std::string text = "data: " + quality.verdict + "\n";
  for (const auto& done : quality.done) text += "  " + done + "\n";
  text += detection_text(quality);
  if (!quality.bands.empty()) text += io::text(bands_table(quality));
  return text + "\n";
}

std::optional<io::ResultTable> quality_table(const steps::IdentifiedModel& model) {
  if (!model.measured.quality || model.measured.quality->bands.empty()) return std::nullopt;
  return bands_table(*model.measured.quality);
}

io::Json quality_json(const steps::IdentifiedModel& model) {
  if (!model.measured.quality) return {};
  const auto& quality = *model.measured.quality;
  io::JsonObject json{{"verdict", quality.verdict},
                      {"responses", io::Json::texts(quality.responses)},
                      {"bands", bands_json(quality)},
                      {"drift", drift_json(quality)},
                      {"clipped", io::Json::texts(quality.faults.clipped)},
                      {"done", io::Json::texts(quality.done)}};
  if (quality.detection) {
    const auto& levels = *quality.detection;
    json.emplace_back("distortion", io::JsonObject{{"sensors", io::Json::texts(quality.outputs)},
                                                   {"even_db", io::Json(levels.even_db)},
                                                   {"odd_db", io::Json(levels.odd_db)},
                                                   {"noise_db", io::Json(levels.noise_db)}});
  }
  return json;
}

void leave_detection_lines(const steps::IdentifiedModel& model, Run& run) {
  const auto file = run / "detection_lines.csv";
  if (!model.measured.quality || !model.measured.quality->detection) {
    std::filesystem::remove(file);  // of a run with such lines
    return;
  }
  const auto& quality = *model.measured.quality;
  const auto& levels = *quality.detection;
  Eigen::VectorXi odd(levels.hz.size());
  for (Eigen::Index k = 0; k < odd.size(); ++k) odd(k) = levels.odd[static_cast<std::size_t>(k)];
  std::vector<io::CsvColumn> columns{{"freq_hz", levels.hz}, {"odd", odd}};
  for (std::size_t i = 0; i < quality.outputs.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    columns.push_back({"level_" + quality.outputs[i], Eigen::VectorXd(levels.level.col(at))});
    columns.push_back({"noise_" + quality.outputs[i], Eigen::VectorXd(levels.noise.col(at))});
  }
  io::write_csv(file, columns);
}

}  // namespace chladni::show
