#include "show/diagnosis/errors_told.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "diagnosis/constants.h"
#include "io/plot.h"

namespace chladni::show {
namespace {

using Eigen::Index;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr int kAfterInk = 1, kBeforeInk = 2, kBandInk = 6;

// Root mean square of the finite values from `first` on; NaN: none.
double mean_error(const Eigen::VectorXd& values, Index first, Index count) {
  double sum = 0.0, finite = 0.0;
  for (Index k = first; k < std::min(first + count, values.size()); ++k) {
    if (!std::isfinite(values(k))) continue;
    sum += values(k) * values(k);
    finite += 1.0;
  }
  return finite > 0.0 ? std::sqrt(sum / finite) : kUnknown;
}

io::PlotSeries series(const std::string& name, const Eigen::VectorXd& frequency_hz,
                      const Eigen::VectorXd& error, int colour) {
  return {.name = name,
          .x = frequency_hz,
          .y = error,
          .upper = {},
          .style = io::PlotSeries::Style::line,
          .colour = colour,
          .width = 1.4};
}

// Place of the largest value of the map.
Index worst_place(const steps::Diagnosed& one) {
  Index place = 0;
  one.result.map.explained.maxCoeff(&place);
  return place;
}

}  // namespace

void draw_errors_over_frequency(const io::PictureFile& png,
                                const steps::ErrorsOverFrequency& errors) {
  const auto& f = errors.frequency_hz;
  if (f.size() == 0) return;
  io::PlotPanel panel;
  panel.x = {.label = "frequency [Hz]", .logarithmic = f(0) > 0.0 && f(f.size() - 1) > 5.0 * f(0)};
  panel.y = {.label = "error over size of all responses", .logarithmic = true};
  panel.series.push_back({.name = "noise and errors of a sound model",
                          .x = f,
                          .y = errors.noise,
                          .upper = errors.expected,
                          .style = io::PlotSeries::Style::band,
                          .colour = kBandInk});
  panel.series.push_back(series("noise", f, errors.noise, kBandInk));
  panel.series.push_back(series("simulated", f, errors.before, kBeforeInk));
  if (errors.after.size() > 0) {
    panel.series.push_back(series("with the causes", f, errors.after, kAfterInk));
  }
  io::Plot plot{.title = "Error of the simulation over frequency", .panels = {}, .columns = 1};
  plot.panels.push_back(std::move(panel));
  io::draw_plot(png, plot);
}

io::ResultTable errors_table(const steps::ErrorsOverFrequency& errors) {
  const Index lines = errors.frequency_hz.size();
  const Index bands = std::min<Index>(diagnosis::kConstants.bands, lines);
  Eigen::VectorXd low(bands), high(bands), before(bands), after(bands), noise(bands),
      expected(bands);
  for (Index b = 0; b < bands; ++b) {
    const Index first = lines * b / bands;
    const Index count = lines * (b + 1) / bands - first;
    low(b) = errors.frequency_hz(first);
    high(b) = errors.frequency_hz(first + count - 1);
    before(b) = mean_error(errors.before, first, count);
    after(b) = mean_error(errors.after, first, count);
    noise(b) = mean_error(errors.noise, first, count);
    expected(b) = mean_error(errors.expected, first, count);
  }
  const io::NumberFormat hertz{"{:.1f}"}, percent{"{:.2f}", 100.0};
  return {"Error over frequency, of all responses together",
          {io::number_column("from", "Hz", low, hertz, 10),
           io::number_column("to", "Hz", high, hertz, 10),
           io::number_column("before", "%", before, percent, 10),
           io::number_column("after", "%", after, percent, 10),
           io::number_column("noise", "%", noise, percent, 10),
           io::number_column("sound model", "%", expected, percent, 13)}};
}

io::JsonObject errors_json(const steps::ErrorsOverFrequency& errors) {
  return {{"frequency_hz", io::Json(errors.frequency_hz)},
          {"before", io::Json(errors.before)},
          {"after", io::Json(errors.after)},
          {"noise", io::Json(errors.noise)},
          {"sound_model", io::Json(errors.expected)}};
}

std::string place_of_error(const steps::Diagnosed& one) {
  const auto& map = one.result.map;
  if (map.explained.size() == 0) return "";
  const Index place = worst_place(one);
  if (!(map.explained(place) > 0.0)) return "";
  const Eigen::Vector2d at = one.structure.surface.places.row(place);
  return fmt::format(
      "on the body: one thing at ({:.1f}, {:.1f}) mm would explain {:.0f} % of the misfit, more "
      "than anywhere else",
      1e3 * at(0), 1e3 * at(1), 100.0 * std::min(map.explained(place), 1.0));
}

io::Json error_on_body_json(const steps::Diagnosed& one) {
  const auto& map = one.result.map;
  if (map.explained.size() == 0) return {};
  const Index place = worst_place(one);
  const auto& places = one.structure.surface.places;
  return io::JsonObject{{"place_m", io::Json(Eigen::VectorXd(places.row(place).transpose()))},
                        {"explained", map.explained(place)},
                        {"places_m", io::Json::rows(places)},
                        {"explained_at_places", io::Json(map.explained)}};
}

}  // namespace chladni::show
