#include "show/figures/stored_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include "base/error.h"
#include "io/frf_file.h"
#include "io/plot.h"
#include "show/comparison.h"
#include "show/diagnosis/errors_told.h"
#include "show/figures/stored_curves.h"
#include "show/identification.h"
#include "steps/diagnosis.h"

namespace chladni::show {
namespace {

using Path = std::filesystem::path;

constexpr int kVermilion = 2, kGrey = 6;
constexpr double k95 = 1.96;  // standard deviations in half of a 95 % band

// A number of a stored file; null is not known.
double stored_number(const io::Json& json) {
  return std::holds_alternative<std::monostate>(json.value()) ? NAN : json.number();
}

Eigen::VectorXd stored_vector(const io::Json& json) {
  const auto& all = json.array();
  Eigen::VectorXd vector(std::ssize(all));
  std::ranges::transform(all, vector.begin(), stored_number);
  return vector;
}

// One row of squares for each array.
Eigen::MatrixXd stored_rows(const io::Json& json, Eigen::Index columns) {
  const auto& rows = json.array();
  Eigen::MatrixXd matrix(std::ssize(rows), columns);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto row = stored_vector(rows[i]);
    require(row.size() == columns,
            fmt::format("a row of {} values, expected {}", row.size(), columns));
    matrix.row(static_cast<Eigen::Index>(i)) = row.transpose();
  }
  return matrix;
}

// The member of an object; null: it has none, or is no object.
const io::Json* member(const io::Json& json, std::string_view key) {
  const auto* object = std::get_if<io::JsonObject>(&json.value());
  if (object == nullptr) return nullptr;
  for (const auto& [name, value] : *object) {
    if (name == key) return &value;
  }
  return nullptr;
}

io::PlotSeries stored_series(const char* name, const std::vector<double>& x,
                             const std::vector<double>& y, io::PlotSeries::Style style,
                             int colour) {
  const auto vector = [](const std::vector<double>& values) -> Eigen::VectorXd {
    return Eigen::Map<const Eigen::VectorXd>(values.data(), std::ssize(values));
  };
  return {.name = name,
          .x = vector(x),
          .y = vector(y),
          .upper = {},
          .style = style,
          .colour = colour,
          .width = 0.0};
}

// A count or a number of a mode.
int whole_number(const io::Json& json) {
  constexpr double kMostWhole = 1e6;
  const double number = json.number();
  require(number >= 0.0 && number <= kMostWhole && std::floor(number) == number,
          fmt::format("found {:.6g}, expected a whole number from 0 to 1000000", number));
  return static_cast<int>(number);
}

// What was compared: of diagnosis.json the part before the causes.
const io::Json& compared_part(const Path& file, const io::Json& content) {
  if (file.filename() != "diagnosis.json") return content;
  const auto& compared = content.at("discrepancy");
  require(!std::holds_alternative<std::monostate>(compared.value()),
          "a diagnosis by modes compared no responses");
  return compared;
}

// The same, of responses. Pairs of modes that were compared alone have no numbers.
const io::Json& compared_responses(const Path& file, const io::Json& content) {
  const auto& compared = compared_part(file, content);
  const auto& pairs = compared.at("modes").array();
  const bool is_of_modes = !pairs.empty() && member(pairs.front(), "measured_hz") != nullptr &&
                           member(pairs.front(), "measured_mode") == nullptr;
  require(!is_of_modes, "a comparison of modes alone has no MAC and no responses");
  return compared;
}

std::vector<std::string> names_in(const io::Json& channels) {
  std::vector<std::string> names;
  for (const auto& one : channels.array()) names.push_back(one.at("name").string());
  return names;
}

// Frequencies [Hz] of modes by their numbers, from the pairs and from the lists of single modes.
std::map<int, double> frequencies_in(const io::Json& compared, const std::string& side) {
  std::map<int, double> hertz;
  for (const auto& pair : compared.at("modes").array()) {
    const int mode = whole_number(pair.at(side + "_mode"));
    hertz[mode] = stored_number(pair.at(side + "_hz"));
  }
  const auto add = [&](const std::string& list) {
    for (const auto& one : compared.at(list).array()) {
      hertz[whole_number(one.at("mode"))] = stored_number(one.at("frequency_hz"));
    }
  };
  const bool simulated = side == "simulated";
  add(simulated ? "simulated_alone" : "measured_alone");
  add(simulated ? "simulated_unseen" : "no_modes");
  return hertz;
}

std::vector<double> frequencies_of(const io::Json& compared, const std::string& side) {
  const auto hertz = frequencies_in(compared, side);
  std::vector<double> all;
  for (const auto& mode : compared.at("mac").at(side + "_modes").array()) {
    const auto found = hertz.find(whole_number(mode));
    all.push_back(found == hertz.end() ? NAN : found->second);
  }
  return all;
}

void draw_stored_mac(const Path& file, const io::Json& content, const io::PictureFile& picture) {
  const auto& compared = compared_responses(file, content);
  diagnosis::Comparison comparison;
  auto& modes = comparison.modes;
  modes.simulated_hz = frequencies_of(compared, "simulated");
  modes.measured_hz = frequencies_of(compared, "measured");
  modes.mac = stored_rows(compared.at("mac").at("value"), std::ssize(modes.measured_hz));
  require(modes.mac.size() > 0, "no modes were compared");
  draw_mac(picture, comparison);
}

void draw_stored_errors(const Path& file, const io::Json& content, const io::PictureFile& picture) {
  const auto& compared = compared_responses(file, content);
  diagnosis::Comparison comparison;
  auto& r = comparison.responses;
  r.outputs = names_in(compared.at("sensors"));
  r.inputs = names_in(compared.at("actuators"));
  r.error.setConstant(std::ssize(r.outputs), std::ssize(r.inputs), NAN);
  for (const auto& one : compared.at("per_channel").array()) {
    const auto i = std::ranges::find(r.outputs, one.at("sensor").string()) - r.outputs.begin();
    const auto j = std::ranges::find(r.inputs, one.at("actuator").string()) - r.inputs.begin();
    require(i < r.error.rows() && j < r.error.cols(), "a response of channels that are not listed");
    r.error(i, j) = stored_number(one.at("relative_error"));
  }
  require(r.error.size() > 0, "no responses were compared");
  draw_errors(picture, comparison);
}

void draw_stored_errors_over_frequency(const Path& file, const io::Json& content,
                                       const io::PictureFile& picture) {
  (void)compared_part(file, content);  // says so where responses were not compared
  const auto& stored = content.at("errors_over_frequency");
  steps::ErrorsOverFrequency errors;
  errors.frequency_hz = stored_vector(stored.at("frequency_hz"));
  errors.before = stored_vector(stored.at("before"));
  errors.after = stored_vector(stored.at("after"));
  errors.noise = stored_vector(stored.at("noise"));
  errors.expected = stored_vector(stored.at("sound_model"));
  require(errors.frequency_hz.size() > 0, "there are no errors over frequency in it");
  draw_errors_over_frequency(picture, errors);
}

// The whole range of the poles, because the band of the fit is not stored.
void draw_stored_stabilisation(const Path& /*file*/, const io::Json& content,
                               const io::PictureFile& picture) {
  steps::IdentifiedModel model;
  double low = INFINITY, high = 0.0;
  const auto is_true = [](const io::Json& json) {
    const auto* truth = std::get_if<bool>(&json.value());
    require(truth != nullptr, "expected true or false");
    return *truth;
  };
  for (const auto& point : content.at("stabilisation").array()) {
    auto& one = model.stabilisation.emplace_back();
    one.order = whole_number(point.at("order"));
    one.frequency_hz = point.at("frequency_hz").number();
    one.stable_frequency = is_true(point.at("stable_frequency"));
    one.stable_damping = is_true(point.at("stable_damping"));
    one.stable_shape = is_true(point.at("stable_shape"));
    low = std::min(low, one.frequency_hz);
    high = std::max(high, one.frequency_hz);
  }
  require(!model.stabilisation.empty(),
          "no diagram was made; [identification] stabilisation = 30, an order, asks for one");
  model.data.frequency_hz = Eigen::Vector2d(low, high);
  std::vector<double> modes;
  for (const auto& mode : content.at("modes").array()) {
    modes.push_back(stored_number(mode.at("frequency_hz")));
  }
  model.found.fit.model.frequency_hz =
      Eigen::Map<const Eigen::VectorXd>(modes.data(), std::ssize(modes));
  io::draw_plot(picture, stabilisation_plot(model));
}

void draw_stored_magnitudes(const Path& /*file*/, const io::Json& content,
                            const io::PictureFile& picture) {
  io::draw_plot(picture, magnitudes_plot(stored_curves(content)));
}

void draw_stored_response(const io::Json& content, std::string_view pair,
                          const io::PictureFile& picture) {
  io::draw_plot(picture, response_plot(stored_curves(content), pair));
}

constexpr auto kCompared = "comparison.json";
constexpr auto kDiagnosed = "diagnosis.json";

const std::array kStored{
    StoredFigure{"frequency_errors",
                 "measured over simulated frequency, less 1, of each pair",
                 {kDiagnosed, kCompared},
                 draw_frequency_errors},
    StoredFigure{
        "mac", "MAC of simulated and measured modes", {kDiagnosed, kCompared}, draw_stored_mac},
    StoredFigure{"errors", "error of each response", {kDiagnosed, kCompared}, draw_stored_errors},
    StoredFigure{"errors_over_frequency",
                 "error of all responses over frequency",
                 {kDiagnosed},
                 draw_stored_errors_over_frequency},
    StoredFigure{
        "stabilisation", "poles of rising order", {"identified.json"}, draw_stored_stabilisation},
    StoredFigure{"fit",
                 "measured and fitted responses; \"fit:s1/a2\": one, with its phase",
                 {"fit_curves.json"},
                 draw_stored_magnitudes,
                 draw_stored_response},
    StoredFigure{"responses",
                 "measured and simulated responses; \"responses:s1/a2\": one, with its phase",
                 {"responses_curves.json"},
                 draw_stored_magnitudes,
                 draw_stored_response},
    StoredFigure{"prediction",
                 "the same, with the causes; \"prediction:s1/a2\": one, with its phase",
                 {"prediction_curves.json"},
                 draw_stored_magnitudes,
                 draw_stored_response},
};

}  // namespace

std::span<const StoredFigure> stored_figures() { return kStored; }

void draw_frequency_errors(const Path& file, const io::Json& content,
                           const io::PictureFile& picture) {
  std::vector<double> at, change, bar_at, bar;  // a bar is two points and a gap
  for (const auto& pair : compared_part(file, content).at("modes").array()) {
    const double one = 100.0 * stored_number(pair.at("change"));
    if (!std::isfinite(one)) continue;
    at.push_back(stored_number(pair.at("simulated_hz")));
    change.push_back(one);
    const auto* std = member(pair, "change_std");
    const double half = std == nullptr ? NAN : 100.0 * k95 * stored_number(*std);
    bar_at.insert(bar_at.end(), 3, at.back());
    bar.insert(bar.end(), {one - half, one + half, NAN});
  }
  require(!at.empty(), "no modes were paired");
  io::PlotPanel panel;
  const auto [low, high] = std::ranges::minmax(at);
  const double room = std::max(0.05 * (high - low), 0.01 * high);
  panel.x = {.label = "simulated frequency [Hz]", .low = low - room, .high = high + room};
  panel.y = {.label = "frequency deviation [%]"};
  panel.series.push_back(
      stored_series("95 % band", bar_at, bar, io::PlotSeries::Style::line, kGrey));
  panel.series.push_back(
      stored_series("pair of modes", at, change, io::PlotSeries::Style::circles, kVermilion));
  io::draw_plot(picture, {.title = "", .panels = {panel}, .columns = 1, .aspect = 0.5});
}

}  // namespace chladni::show
