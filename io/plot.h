// Line plots: curves over axes, in panels beside each other.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace chladni::io {

struct PlotAxis {
  std::string label;  ///< with its unit: "frequency [Hz]"
  bool logarithmic = false;
  double low = 0.0, high = 0.0;  ///< the range; equal: that of the series, with some room in y
};

/// n points. What is not finite, or not above 0 on a logarithmic axis, is a gap.
struct PlotSeries {
  enum class Style { line, dashed, dots, circles, crosses, plusses, band };

  std::string name;  ///< in the legend; empty: not there. One entry per name in all panels
  Eigen::VectorXd x, y;
  Eigen::VectorXd upper;  ///< of a band: from y to here
  Style style = Style::line;
  int colour = 1;      ///< 0 ink, 1 blue, 2 vermilion, 3 green, 4 purple, 5 orange, 6 grey
  double width = 1.6;  ///< of lines, diameter of marks [px]; 0: the style's own
};

struct PlotPanel {
  std::string title;
  PlotAxis x, y;
  std::vector<PlotSeries> series;  ///< the first lies below the others
  std::vector<double> verticals;   ///< places in x of thin dashed lines
};

struct Plot {
  std::string title;
  std::vector<PlotPanel> panels;  ///< row by row
  int columns = 0;                ///< 0: as many as make rows and columns alike, at most 4
  double aspect = 0.62;           ///< height of a panel over its width
};

/// PNG, 1000 px wide, 1400 where there are three columns or more; at most 64 panels. Axes are
/// labelled at the left and the bottom, ticks in every panel. The same input gives the same bytes.
/// @throws InvalidInput  a series whose arrays differ in length, no panel, more than 64
/// @throws WorkerDied    as draw_modes
void draw_plot(const std::filesystem::path& png, const Plot& plot);

}  // namespace chladni::io
