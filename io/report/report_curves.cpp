// Curves in few bytes: each value is a code between the limits of its pane, 0 is a gap.
#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "io/bytes/escape.h"
#include "io/json.h"
#include "io/report/report_blocks.h"

namespace chladni::io {
namespace {

bool is_band(const Curves::Series& series) { return series.style == PlotSeries::Style::band; }

// The series of each array of a choice.
std::vector<std::pair<const Curves::Pane*, const Curves::Series*>> arrays_of(const Curves& curves) {
  std::vector<std::pair<const Curves::Pane*, const Curves::Series*>> arrays;
  for (const auto& pane : curves.panes) {
    for (const auto& series : pane.series) {
      arrays.insert(arrays.end(), is_band(series) ? 2 : 1, {&pane, &series});
    }
  }
  return arrays;
}

bool is_drawn(const PlotAxis& axis, double value) {
  return std::isfinite(value) && (!axis.logarithmic || value > 0.0);
}

// The axis of the pane with its fixed range, or with the range of all its values.
PlotAxis ranged(const Curves& curves, const Curves::Pane& pane) {
  PlotAxis axis = pane.axis;
  if (axis.low < axis.high) return axis;
  axis.low = std::numeric_limits<double>::infinity();
  axis.high = -axis.low;
  const auto arrays = arrays_of(curves);
  for (const auto& choice : curves.choices) {
    for (std::size_t a = 0; a < arrays.size(); ++a) {
      if (arrays[a].first != &pane) continue;
      for (const double value : choice.y[a]) {
        if (!is_drawn(axis, value)) continue;
        axis.low = std::min(axis.low, value);
        axis.high = std::max(axis.high, value);
      }
    }
  }
  if (!(axis.low <= axis.high)) axis.low = axis.high = 1.0;  // nothing is drawn
  if (axis.low == axis.high) axis.high += axis.logarithmic ? axis.high : 1.0;
  return axis;
}

template <class Code>
std::string bytes_of(const std::vector<Code>& codes) {
  static_assert(std::endian::native == std::endian::little);
  return base64({reinterpret_cast<const char*>(codes.data()), codes.size() * sizeof(Code)});
}

template <class Code>
std::string packed_values(const Eigen::VectorXd& values, const PlotAxis& axis) {
  constexpr double most = std::numeric_limits<Code>::max() - 1;
  std::vector<Code> codes;
  codes.reserve(static_cast<std::size_t>(values.size()));
  for (const double value : values) {
    double part = (value - axis.low) / (axis.high - axis.low);
    if (axis.logarithmic) part = std::log(value / axis.low) / std::log(axis.high / axis.low);
    codes.push_back(is_drawn(axis, value)
                        ? static_cast<Code>(1 + std::lround(most * std::clamp(part, 0.0, 1.0)))
                        : Code{0});
  }
  return bytes_of(codes);
}

std::string packed_lines(const Eigen::VectorXd& x) {
  const Eigen::VectorXf single = x.cast<float>();
  return bytes_of(std::vector<float>(single.begin(), single.end()));
}

const char* style_name(PlotSeries::Style style) {
  using Style = PlotSeries::Style;
  switch (style) {
    case Style::line:
      return "line";
    case Style::dashed:
      return "dashed";
    case Style::dots:
      return "dots";
    case Style::circles:
      return "circles";
    case Style::crosses:
      return "crosses";
    case Style::plusses:
      return "plusses";
    case Style::band:
      break;
  }
  return "band";
}

Json pane_json(const Curves::Pane& pane, const PlotAxis& axis) {
  JsonArray all;
  for (const auto& series : pane.series) {
    all.emplace_back(JsonObject{{"name", series.name},
                                {"style", style_name(series.style)},
                                {"colour", series.colour},
                                {"x", static_cast<long long>(series.x)}});
  }
  JsonObject json{{"label", axis.label},      {"log", axis.logarithmic},
                  {"low", axis.low},          {"high", axis.high},
                  {"height", pane.height},    {"bits", pane.coarse ? 8 : 16},
                  {"series", std::move(all)}, {"fixed", pane.axis.low < pane.axis.high}};
  if (!pane.ticks.empty()) {
    json.emplace_back("ticks", JsonArray(pane.ticks.begin(), pane.ticks.end()));
  }
  return json;
}

Json choice_json(const Curves& curves, const Curves::Choice& choice,
                 const std::vector<PlotAxis>& axes) {
  const auto arrays = arrays_of(curves);
  std::vector<std::string> values;
  for (std::size_t a = 0; a < arrays.size(); ++a) {
    const auto* pane = arrays[a].first;
    const PlotAxis& axis = axes[static_cast<std::size_t>(pane - curves.panes.data())];
    values.push_back(pane->coarse ? packed_values<std::uint8_t>(choice.y[a], axis)
                                  : packed_values<std::uint16_t>(choice.y[a], axis));
  }
  return JsonObject{{"name", choice.name}, {"y", Json::texts(values)}};
}

Json curves_json(const Curves& curves) {
  std::vector<PlotAxis> axes;
  JsonArray panes, choices;
  for (const auto& pane : curves.panes) {
    axes.push_back(ranged(curves, pane));
    panes.push_back(pane_json(pane, axes.back()));
  }
  for (const auto& choice : curves.choices) choices.push_back(choice_json(curves, choice, axes));
  std::vector<std::string> lines;
  for (const auto& x : curves.x) lines.push_back(packed_lines(x));
  return JsonObject{{"name", curves.name},
                    {"chooser", curves.chooser},
                    {"label", curves.axis.label},
                    {"short", curves.axis.label.substr(0, curves.axis.label.find(" ["))},
                    {"log", curves.axis.logarithmic},
                    {"x", Json::texts(lines)},
                    {"panes", std::move(panes)},
                    {"choices", std::move(choices)},
                    {"verticals", JsonArray(curves.verticals.begin(), curves.verticals.end())}};
}

}  // namespace

void check_curves(const Curves& curves) {
  const std::string what = "report: curves \"" + curves.name + "\": ";
  require(!curves.choices.empty(), what + "nothing to choose");
  const auto arrays = arrays_of(curves);
  for (const auto& choice : curves.choices) {
    require(choice.y.size() == arrays.size(),
            fmt::format("{}\"{}\" has {} arrays, expected {}", what, choice.name, choice.y.size(),
                        arrays.size()));
    for (std::size_t a = 0; a < arrays.size(); ++a) {
      const auto x = arrays[a].second->x;
      require(x < curves.x.size(), what + "a series has no x");
      require(choice.y[a].size() == 0 || choice.y[a].size() == curves.x[x].size(),
              fmt::format("{}\"{}\" has {} values over {} lines", what, choice.name,
                          choice.y[a].size(), curves.x[x].size()));
    }
  }
}

void append_curves(std::string& page, const Curves& curves) {
  page += "<figure class=\"curves\">\n<div class=\"head\"><label>" + escaped(curves.chooser) +
          " <select></select></label><div class=\"actions\"></div></div>\n"
          "<div class=\"panes\" role=\"group\" tabindex=\"0\"></div>\n"
          "<p class=\"message quiet\">The curves need scripts.</p>\n<div class=\"sheet\"></div>\n";
  if (!curves.caption.empty()) page += "<figcaption>" + escaped(curves.caption) + "</figcaption>\n";
  page += "<script type=\"application/json\">" + script_safe(text(curves_json(curves))) +
          "</script>\n</figure>\n";
}

}  // namespace chladni::io
