#include "show/figures/stored_curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "show/identification/response_series.h"
#include "study/problems.h"

namespace chladni::show {
namespace {

using CurveStyle = io::PlotSeries::Style;

constexpr std::size_t kMostOfTwo = 24;      // letters of a title above one of two panels
constexpr std::size_t kMostMagnitudes = 6;  // more are higher than a page of paper
constexpr std::array kStyles{
    std::pair{"line", CurveStyle::line},       std::pair{"dashed", CurveStyle::dashed},
    std::pair{"dots", CurveStyle::dots},       std::pair{"circles", CurveStyle::circles},
    std::pair{"crosses", CurveStyle::crosses}, std::pair{"plusses", CurveStyle::plusses},
    std::pair{"band", CurveStyle::band}};

const char* style_name(CurveStyle style) {
  return std::ranges::find(kStyles, style, &std::pair<const char*, CurveStyle>::second)->first;
}

CurveStyle style_called(const std::string& name) {
  const auto found =
      std::ranges::find_if(kStyles, [&](const auto& one) { return name == one.first; });
  require(found != kStyles.end(), "a curve of the unknown style \"" + name + "\"");
  return found->second;
}

std::size_t array_count(const io::Curves::Series& series) {
  return series.style == CurveStyle::band ? 2 : 1;
}

// Number of arrays of the panes before `pane`.
std::size_t arrays_before(const io::Curves& curves, std::size_t pane) {
  std::size_t count = 0;
  for (std::size_t p = 0; p < pane; ++p) {
    for (const auto& series : curves.panes[p].series) count += array_count(series);
  }
  return count;
}

// @throws InvalidInput  there is not one grid, or an array is missing or of another length
void require_whole(const io::Curves& curves) {
  require(curves.x.size() == 1 && curves.x[0].size() > 0 && !curves.choices.empty(),
          "curves: expected one grid of frequencies and at least one response");
  const auto arrays = arrays_before(curves, curves.panes.size());
  for (const auto& choice : curves.choices) {
    require(choice.y.size() == arrays, fmt::format("the response \"{}\" has {} curves, expected {}",
                                                   choice.name, choice.y.size(), arrays));
    for (const auto& y : choice.y) {
      require(y.size() == 0 || y.size() == curves.x[0].size(),
              fmt::format("a curve of \"{}\" has {} values, expected {}", choice.name, y.size(),
                          curves.x[0].size()));
    }
  }
}

// The least file that no eye tells from all digits.
io::Json in_seven_digits(const Eigen::VectorXd& values) {
  const Eigen::VectorXd rounded = values.unaryExpr(
      [](double v) { return std::isfinite(v) ? std::stod(fmt::format("{:.7g}", v)) : v; });
  return io::Json(rounded);
}

io::JsonObject axis_members(const io::PlotAxis& axis) {
  return {{"label", axis.label},
          {"logarithmic", axis.logarithmic},
          {"low", axis.low},
          {"high", axis.high}};
}

io::PlotAxis axis_in(const io::Json& json) {
  const auto* logarithmic = std::get_if<bool>(&json.at("logarithmic").value());
  require(logarithmic != nullptr, "an axis is logarithmic or not; expected true or false");
  return {.label = json.at("label").string(),
          .logarithmic = *logarithmic,
          .low = json.at("low").number(),
          .high = json.at("high").number()};
}

Eigen::VectorXd curve_in(const io::Json& json) {
  const auto& all = json.array();
  Eigen::VectorXd values(std::ssize(all));
  std::ranges::transform(all, values.begin(), [](const io::Json& one) {
    return std::holds_alternative<std::monostate>(one.value()) ? NAN : one.number();
  });
  return values;
}

int colour_in(const io::Json& json) {
  const double colour = json.number();
  require(colour >= 0.0 && colour <= 6.0, fmt::format("a curve of the unknown colour {}", colour));
  return static_cast<int>(colour);
}

// Without lines where a phase jumps from one end of its axis to the other.
void leave_gaps(Eigen::VectorXd& x, Eigen::VectorXd& y) {
  constexpr double kHalfTurn = 180.0;
  std::vector<double> at, value;
  for (Eigen::Index k = 0; k < y.size(); ++k) {
    if (k > 0 && std::abs(y(k) - y(k - 1)) > kHalfTurn) {
      at.push_back(x(k));
      value.push_back(NAN);
    }
    at.push_back(x(k));
    value.push_back(y(k));
  }
  x = Eigen::Map<const Eigen::VectorXd>(at.data(), std::ssize(at));
  y = Eigen::Map<const Eigen::VectorXd>(value.data(), std::ssize(value));
}

io::PlotPanel panel_in(const io::Curves& curves, const io::Curves::Choice& choice,
                       std::size_t pane) {
  const auto& shown = curves.panes[pane];
  io::PlotPanel panel;
  panel.x = curves.axis;
  panel.y = shown.axis;
  const bool fixed = shown.axis.high > shown.axis.low;
  auto at = arrays_before(curves, pane);
  for (const auto& series : shown.series) {
    const auto first = at;
    at += array_count(series);
    if (choice.y[first].size() == 0) continue;
    io::PlotSeries one{.name = series.name,
                       .x = curves.x[0],
                       .y = choice.y[first],
                       .upper = {},
                       .style = series.style,
                       .colour = series.colour,
                       .width = series.style == CurveStyle::line ? 1.4 : 0.0};
    if (series.style == CurveStyle::band) one.upper = choice.y[first + 1];
    if (series.style == CurveStyle::line && fixed) leave_gaps(one.x, one.y);
    panel.series.push_back(std::move(one));
  }
  if (shown.axis.logarithmic && !fixed) range_by_curves(panel);
  return panel;
}

// Without its error, which a narrow panel has no room for.
std::string title_of(const io::Curves::Choice& choice) {
  return choice.name.substr(0, choice.name.rfind(", off by "));
}

// "s1 by a2" of "s1 by a2, held out, off by 5.1 %" or "s1 by a2 [m/N], off by 5.1 %".
bool is_of(const std::string& choice, const std::string& response) {
  if (!choice.starts_with(response)) return false;
  const auto rest = std::string_view(choice).substr(response.size());
  return rest.empty() || rest.starts_with(", ") || rest.starts_with(" [");
}

}  // namespace

io::JsonObject curves_json(const io::Curves& curves) {
  require_whole(curves);
  io::JsonArray panes, responses;
  for (const auto& pane : curves.panes) {
    io::JsonArray series;
    for (const auto& one : pane.series) {
      series.push_back(io::JsonObject{
          {"name", one.name}, {"style", style_name(one.style)}, {"colour", one.colour}});
    }
    auto members = axis_members(pane.axis);
    members.emplace_back("series", std::move(series));
    panes.emplace_back(std::move(members));
  }
  for (const auto& choice : curves.choices) {
    io::JsonArray values;
    for (const auto& y : choice.y) values.push_back(in_seven_digits(y));
    responses.push_back(io::JsonObject{{"name", choice.name}, {"values", std::move(values)}});
  }
  return {{"caption", curves.caption},
          {"axis", axis_members(curves.axis)},
          {"frequency_hz", in_seven_digits(curves.x[0])},
          {"panes", std::move(panes)},
          {"responses", std::move(responses)}};
}

io::Curves stored_curves(const io::Json& content) {
  io::Curves curves;
  curves.caption = content.at("caption").string();
  curves.axis = axis_in(content.at("axis"));
  curves.x = {curve_in(content.at("frequency_hz"))};
  for (const auto& stored : content.at("panes").array()) {
    auto& pane = curves.panes.emplace_back();
    pane.axis = axis_in(stored);
    for (const auto& one : stored.at("series").array()) {
      pane.series.push_back({.name = one.at("name").string(),
                             .style = style_called(one.at("style").string()),
                             .colour = colour_in(one.at("colour"))});
    }
  }
  for (const auto& stored : content.at("responses").array()) {
    auto& choice = curves.choices.emplace_back();
    choice.name = stored.at("name").string();
    for (const auto& y : stored.at("values").array()) choice.y.push_back(curve_in(y));
  }
  require_whole(curves);
  require(curves.panes.size() >= 2, "curves: expected a magnitude and a phase");
  return curves;
}

void leave_curves(Run& run, const std::string& file, const std::function<io::Curves()>& curves) {
  if (!run.options().pictures) return;
  io::JsonObject json;
  try {
    json = curves_json(curves());
  } catch (const InvalidInput&) {
    return;  // nothing was measured: the picture says so
  }
  run.leave(file, std::move(json), false);
}

io::Plot magnitudes_plot(const io::Curves& curves) {
  io::Plot plot;
  for (const auto& choice : curves.choices) {
    if (plot.panels.size() == kMostMagnitudes) break;
    plot.panels.push_back(panel_in(curves, choice, 0));
    plot.panels.back().title = title_of(choice);
    if (plot.panels.back().title.size() <= kMostOfTwo) continue;
    plot.columns = 1;  // two beside each other would cut the name
    plot.aspect = 0.35;
  }
  return plot;
}

io::Plot response_plot(const io::Curves& curves, std::string_view pair) {
  const auto slash = pair.find('/');
  std::vector<std::string> known;
  for (const auto& choice : curves.choices) {
    const auto by = choice.name.find(" by ");
    const auto end = std::min(choice.name.find(", ", by), choice.name.find(" [", by));
    auto name = choice.name.substr(0, end);
    known.push_back(by == std::string::npos ? name : name.replace(by, 4, "/"));
  }
  require(slash != std::string_view::npos,
          fmt::format("\"{}\" is no response; expected {}", pair, study::listed(known)));
  const auto response = fmt::format("{} by {}", pair.substr(0, slash), pair.substr(slash + 1));
  const auto found = std::ranges::find_if(
      curves.choices, [&](const auto& choice) { return is_of(choice.name, response); });
  require(found != curves.choices.end(),
          fmt::format("there are no curves of \"{}\"; expected {}", pair, study::listed(known)));
  io::Plot plot{.title = "", .panels = {}, .columns = 1, .aspect = 0.45};
  plot.panels = {panel_in(curves, *found, 0), panel_in(curves, *found, 1)};
  plot.panels[0].title = title_of(*found);
  return plot;
}

}  // namespace chladni::show
