#include "io/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "base/error.h"
#include "io/figure/drawing.h"
#include "io/figure/painted.h"
#include "io/figure/plot_axis.h"
#include "io/figure/plot_curve.h"

namespace chladni::io {
namespace {

using Path = Drawing::Path;
using Place = Eigen::Vector2d;

constexpr Colour kInk{0.13, 0.14, 0.16}, kGrey{0.45, 0.47, 0.50}, kGrid{0.90, 0.905, 0.91},
    kFrame{0.62, 0.63, 0.65};
// Wong's colours, which colour-blind readers can also distinguish (Nature Methods 8 (2011) 441).
constexpr std::array<Colour, 7> kColours{kInk,
                                         Colour{0.00, 0.45, 0.70},
                                         Colour{0.84, 0.37, 0.00},
                                         Colour{0.00, 0.62, 0.45},
                                         Colour{0.80, 0.47, 0.65},
                                         Colour{0.90, 0.62, 0.00},
                                         Colour{0.60, 0.61, 0.63}};
constexpr double kMargin = 24.0, kTitle = 24.0, kTick = 14.0, kLabel = 16.0, kLegend = 16.0;

Colour colour_of(int index) {
  return kColours[static_cast<std::size_t>(std::abs(index)) % kColours.size()];
}

// The colour of a band: mixed with white.
Colour pale(const Colour& colour) {
  Colour result;
  for (std::size_t c = 0; c < 3; ++c) result[c] = 0.72 + 0.28 * colour[c];
  return result;
}

Path circle(const Place& centre, double radius, int corners) {
  Path path;
  for (int c = 0; c <= corners; ++c) {
    const double angle = 2.0 * std::numbers::pi * c / corners;
    path.emplace_back(centre + radius * Place(std::cos(angle), std::sin(angle)));
  }
  return path;
}

// Adds a mark at a place: a filled dot (polygon) or strokes.
void add_mark(PlotSeries::Style style, const Place& at, double radius, std::vector<Path>& marks) {
  const auto stroke = [&](double x, double y) {
    marks.push_back({at - radius * Place(x, y), at + radius * Place(x, y)});
  };
  if (style == PlotSeries::Style::circles) {
    marks.push_back(circle(at, radius, 16));
  } else if (style == PlotSeries::Style::crosses) {
    stroke(0.8, 0.8);
    stroke(0.8, -0.8);
  } else if (style == PlotSeries::Style::plusses) {
    stroke(1.0, 0.0);
    stroke(0.0, 1.0);
  } else {
    marks.push_back(circle(at, radius, 8));
    marks.back().pop_back();
  }
}

double size_of(const PlotSeries& series) {
  if (series.width > 0.0 && series.width != PlotSeries{}.width) return series.width;
  switch (series.style) {
    case PlotSeries::Style::dots:
      return 3.0;
    case PlotSeries::Style::circles:
    case PlotSeries::Style::crosses:
    case PlotSeries::Style::plusses:
      return 8.0;
    default:
      return PlotSeries{}.width;
  }
}

void paint_marks(Drawing& drawing, const PlotSeries& series, const std::vector<Place>& places) {
  std::set<std::pair<long, long>> seen;  // marks within half a pixel are drawn once
  std::vector<Path> marks;
  for (const auto& place : places) {
    if (!seen.emplace(std::lround(2.0 * place.x()), std::lround(2.0 * place.y())).second) continue;
    add_mark(series.style, place, 0.5 * size_of(series), marks);
  }
  if (series.style == PlotSeries::Style::dots) {
    drawing.polygons(marks, colour_of(series.colour));
  } else {
    drawing.lines(marks, colour_of(series.colour), 1.4);
  }
}

void paint_band(Drawing& drawing, const PlotSeries& series, const PlotFrame& frame) {
  std::vector<Path> quads;
  const double top = frame.corner.y(), bottom = top + frame.size.y();
  // Values of zero and less lie below a logarithmic axis.
  const auto at = [&](Eigen::Index k, double value) {
    const bool below = frame.y.logarithmic && value <= 0.0;
    Place place = frame.at(series.x(k), below ? frame.y.low : value);
    place.y() = std::clamp(place.y(), top, bottom);
    return place;
  };
  for (Eigen::Index k = 0; k + 1 < series.x.size(); ++k) {
    const Path quad{at(k, series.y(k)), at(k, series.upper(k)), at(k + 1, series.upper(k + 1)),
                    at(k + 1, series.y(k + 1))};
    const bool inside =
        std::all_of(quad.begin(), quad.end(), [&](const Place& p) { return frame.holds(p); });
    if (inside) quads.push_back(quad);
  }
  drawing.polygons(quads, pale(colour_of(series.colour)));
}

void paint_series(Drawing& drawing, const PlotSeries& series, const PlotFrame& frame) {
  switch (series.style) {
    case PlotSeries::Style::band:
      return paint_band(drawing, series, frame);
    case PlotSeries::Style::line:
      return drawing.lines(plot_curve(frame, series.x, series.y), colour_of(series.colour),
                           size_of(series));
    case PlotSeries::Style::dashed:
      return drawing.lines(dashed(plot_curve(frame, series.x, series.y)), colour_of(series.colour),
                           size_of(series));
    default:
      break;
  }
  std::vector<Place> places;
  for (Eigen::Index k = 0; k < series.x.size(); ++k) {
    const Place place = frame.at(series.x(k), series.y(k));
    if (frame.holds(place)) places.push_back(place);
  }
  paint_marks(drawing, series, places);
}

void paint_tick_words(Drawing& drawing, const PlotTick& tick, const Place& at, bool is_x) {
  using Align = Drawing::Align;
  if (tick.exponent.empty()) {
    drawing.text(at, tick.words, kTick, kInk, is_x ? Align::centre : Align::right);
    return;
  }
  const double wide = text_width(tick.words, kTick), raised = text_width(tick.exponent, 11.0);
  const double left = is_x ? at.x() - 0.5 * (wide + raised) : at.x() - wide - raised;
  drawing.text({left, at.y()}, tick.words, kTick, kInk);
  drawing.text({left + wide, at.y() - 6.0}, tick.exponent, 11.0, kInk);
}

void paint_axes(Drawing& drawing, const PlotPanel& panel, const PlotFrame& frame) {
  const double left = frame.corner.x(), top = frame.corner.y();
  const double right = left + frame.size.x(), bottom = top + frame.size.y();
  std::vector<Path> grid, marks;
  for (const auto& tick : plot_ticks(frame.x, frame.size.x(), 62.0)) {
    const double x = left + frame.size.x() * along(frame.x, tick.value);
    const bool small = tick.words.empty();
    if (!small) grid.push_back({{x, top}, {x, bottom}});
    marks.push_back({{x, bottom}, {x, bottom + (small ? 3.0 : 5.0)}});
    paint_tick_words(drawing, tick, {x, bottom + 20.0}, true);
  }
  for (const auto& tick : plot_ticks(frame.y, frame.size.y(), 34.0)) {
    const double y = bottom - frame.size.y() * along(frame.y, tick.value);
    const bool small = tick.words.empty();
    if (!small) grid.push_back({{left, y}, {right, y}});
    marks.push_back({{left - (small ? 3.0 : 5.0), y}, {left, y}});
    paint_tick_words(drawing, tick, {left - 8.0, y + 6.0}, false);
  }
  drawing.lines(grid, kGrid, 0.8);
  drawing.lines(marks, kFrame, 1.0);
  std::vector<Path> verticals;
  for (const double x : panel.verticals) {
    const double at = left + frame.size.x() * along(frame.x, x);
    if (at >= left && at <= right) verticals.push_back({{at, top}, {at, bottom}});
  }
  drawing.lines(dashed(verticals, 3.0, 3.0), kFrame, 0.8);
}

void paint_panel(Drawing& drawing, const PlotPanel& panel, const PlotFrame& frame) {
  paint_axes(drawing, panel, frame);
  for (const auto& series : panel.series) {
    if (series.style == PlotSeries::Style::band) paint_series(drawing, series, frame);
  }
  for (const auto& series : panel.series) {
    if (series.style != PlotSeries::Style::band) paint_series(drawing, series, frame);
  }
  const Place a = frame.corner, b = frame.corner + frame.size;
  drawing.lines({{a, {b.x(), a.y()}, b, {a.x(), b.y()}, a}}, kFrame, 1.0);
  drawing.text({a.x(), a.y() - 8.0}, panel.title, kLabel, kInk, Drawing::Align::left, true);
}

// The frame of a panel. The range in y covers the values within the range in x.
PlotFrame frame_of(const PlotPanel& panel) {
  std::vector<double> x, y;
  for (const auto& series : panel.series) x.insert(x.end(), series.x.begin(), series.x.end());
  PlotFrame frame;
  frame.x = ranged(panel.x, x, 0.0);
  for (const auto& series : panel.series) {
    for (Eigen::Index k = 0; k < series.x.size(); ++k) {
      const double at = along(frame.x, series.x(k));
      if (!(at >= 0.0 && at <= 1.0)) continue;
      y.push_back(series.y(k));
      if (series.upper.size() > 0) y.push_back(series.upper(k));
    }
  }
  frame.y = ranged(panel.y, y, 0.05);
  return frame;
}

// Paints a sample of a series, 30 px wide.
void paint_sample(Drawing& drawing, const PlotSeries& series, const Place& a) {
  const Place b = a + Place(30.0, 0.0), up(0.0, -6.0);
  const Colour colour = colour_of(series.colour);
  switch (series.style) {
    case PlotSeries::Style::line:
      return drawing.lines({{a, b}}, colour, size_of(series));
    case PlotSeries::Style::dashed:
      return drawing.lines(dashed({{a, b}}), colour, size_of(series));
    case PlotSeries::Style::band:
      return drawing.polygons({{a + up, b + up, b - up, a - up}}, pale(colour));
    default:
      paint_marks(drawing, series, {a + Place(5, 0), a + Place(15, 0), a + Place(25, 0)});
  }
}

/// An entry of the legend and its place.
struct Entry {
  const PlotSeries* series = nullptr;
  Place at;
};

// The entries of the legend: every name once, on as many lines as needed.
std::vector<Entry> legend_of(const Plot& plot, double top, double width) {
  std::set<std::string> names;
  std::vector<Entry> entries;
  Place at(kMargin, top);
  for (const auto& panel : plot.panels) {
    for (const auto& series : panel.series) {
      if (series.name.empty() || !names.insert(series.name).second) continue;
      const double wide = 44.0 + text_width(series.name, kLegend);
      if (at.x() > kMargin && at.x() + wide > width - kMargin) at = {kMargin, at.y() + 26.0};
      entries.push_back({&series, at});
      at.x() += wide + 22.0;
    }
  }
  return entries;
}

double width_of(const Plot& plot, const PictureFile& file) {
  const bool wide = plot.columns > 2 || (plot.columns <= 0 && plot.panels.size() > 4);
  return file.layout_width(wide ? 1400.0 : 1000.0);
}

void check(const Plot& plot) {
  require(!plot.panels.empty() && plot.panels.size() <= 64,
          "plot: " + fmt::to_string(plot.panels.size()) + " panels, expected 1 to 64");
  for (const auto& panel : plot.panels) {
    for (const auto& series : panel.series) {
      const bool is_band = series.style == PlotSeries::Style::band;
      require(series.x.size() == series.y.size() &&
                  (!is_band || series.upper.size() == series.x.size()),
              "plot: the series \"" + series.name + "\" has arrays of different length");
    }
  }
}

/// The layout of the picture [px].
struct Sheet {
  int columns = 1, rows = 1;
  double width = 1000.0, height = 0.0, first = 0.0;  ///< first: top of the first row of panels
  double gap = 74.0;                                 ///< between two columns
  Place panel;                                       ///< size of each
  static constexpr double kLeft = kMargin + 80.0, kGapWithLabel = 96.0, kGapY = 66.0;

  [[nodiscard]] Place corner(int p) const {
    return {kLeft + (p % columns) * (panel.x() + gap), first + (p / columns) * (panel.y() + kGapY)};
  }
};

// True for the panels of the first column, and where the axis is another than the left neighbour's.
bool has_own_label(const Plot& plot, int columns, int p) {
  const auto panel = static_cast<std::size_t>(p);
  return p % columns == 0 || plot.panels[panel].y.label != plot.panels[panel - 1].y.label;
}

// On paper as many columns as there is room for, 230 px for a panel.
int most_columns(double width, const PictureFile& file) {
  if (!file.print()) return 8;
  return std::max(1, static_cast<int>((width - Sheet::kLeft - kMargin + 74.0) / (230.0 + 74.0)));
}

Sheet sheet_of(const Plot& plot, double width, int most_columns, double below_legend) {
  const int count = static_cast<int>(plot.panels.size());
  const int even = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(count))));
  Sheet sheet;
  sheet.columns = std::clamp(plot.columns > 0 ? plot.columns : std::min(even, 4), 1, 8);
  sheet.columns = std::min(sheet.columns, most_columns);
  sheet.rows = (count + sheet.columns - 1) / sheet.columns;
  sheet.width = width;
  for (int p = 0; p < count; ++p) {
    const bool inside = p % sheet.columns != 0;
    if (inside && has_own_label(plot, sheet.columns, p)) sheet.gap = Sheet::kGapWithLabel;
  }
  sheet.panel.x() =
      (sheet.width - Sheet::kLeft - kMargin - (sheet.columns - 1) * sheet.gap) / sheet.columns;
  sheet.panel.y() = sheet.panel.x() * std::clamp(plot.aspect, 0.2, 2.0);
  sheet.first = below_legend;
  sheet.height = std::ceil(sheet.first + sheet.rows * sheet.panel.y() +
                           (sheet.rows - 1) * Sheet::kGapY + 66.0);
  return sheet;
}

// Paints labels beside the first column, beside each panel whose axis is another than the left
// neighbour's, and below the last panel of each column.
void paint_labels(Drawing& drawing, const Plot& plot, const Sheet& sheet, int p) {
  const auto& panel = plot.panels[static_cast<std::size_t>(p)];
  const Place corner = sheet.corner(p), middle = corner + 0.5 * sheet.panel;
  if (has_own_label(plot, sheet.columns, p)) {
    drawing.text({corner.x() - 66.0, middle.y()}, panel.y.label, kLabel, kInk,
                 Drawing::Align::centre, false, true);
  }
  if (p + sheet.columns >= static_cast<int>(plot.panels.size())) {
    drawing.text({middle.x(), corner.y() + sheet.panel.y() + 44.0}, panel.x.label, kLabel, kInk,
                 Drawing::Align::centre);
  }
}

}  // namespace

void draw_plot(const PictureFile& png, const Plot& plot) {
  check(plot);
  const std::string title = png.print() ? "" : plot.title;  // on paper it is in the caption
  const double width = width_of(plot, png);
  const double head = title.empty() ? 16.0 : 60.0;
  const auto legend = legend_of(plot, head + 20.0, width);
  const bool titled = std::any_of(plot.panels.begin(), plot.panels.end(),
                                  [](const PlotPanel& panel) { return !panel.title.empty(); });
  const double below =
      (legend.empty() ? head : legend.back().at.y() + 8.0) + (titled ? 34.0 : 16.0);
  const Sheet sheet = sheet_of(plot, width, most_columns(width, png), below);
  Drawing drawing(sheet.width, sheet.height);
  double size = kTitle;
  while (size > 14.0 && text_width(title, size) > sheet.width - 2.0 * kMargin) size -= 1.0;
  drawing.text({kMargin, 40.0}, title, size, kInk, Drawing::Align::left, true);
  for (const auto& entry : legend) {
    paint_sample(drawing, *entry.series, entry.at - Place(0.0, 6.0));
    drawing.text(entry.at + Place(38.0, 0.0), entry.series->name, kLegend, kInk);
  }
  for (int p = 0; p < static_cast<int>(plot.panels.size()); ++p) {
    PlotFrame frame = frame_of(plot.panels[static_cast<std::size_t>(p)]);
    frame.corner = sheet.corner(p);
    frame.size = sheet.panel;
    paint_panel(drawing, plot.panels[static_cast<std::size_t>(p)], frame);
    paint_labels(drawing, plot, sheet, p);
  }
  leave_drawing(png, drawing);
}

}  // namespace chladni::io
