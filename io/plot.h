// Line plots: panels beside each other, with curves over axes.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "io/picture_file.h"

namespace chladni::io {

struct PlotAxis {
  std::string label;  ///< with its unit: "frequency [Hz]"
  bool logarithmic = false;
  double low = 0.0, high = 0.0;  ///< range; if equal: range of the series, with some room in y
};

/// A series of n points. A value that is not finite, or not above 0 on a logarithmic axis, makes a
/// gap.
struct PlotSeries {
  enum class Style { line, dashed, dots, circles, crosses, plusses, band };

  std::string name;  ///< in the legend, once per name for all panels; empty: no entry
  Eigen::VectorXd x, y;
  Eigen::VectorXd upper;  ///< upper limit of a band; y is the lower limit
  Style style = Style::line;
  int colour = 1;      ///< 0 ink, 1 blue, 2 vermilion, 3 green, 4 purple, 5 orange, 6 grey
  double width = 1.6;  ///< of lines, or diameter of marks [px]; 0: the style's default
};

struct PlotPanel {
  std::string title;
  PlotAxis x, y;
  std::vector<PlotSeries> series;  ///< the first one is drawn below the others
  std::vector<double> verticals;   ///< x values of thin dashed lines
};

struct Plot {
  std::string title;
  std::vector<PlotPanel> panels;  ///< row by row
  int columns = 0;                ///< 0: about as many columns as rows, at most 4
  double aspect = 0.62;           ///< height of a panel over its width
};

/// Draws a PNG, 1000 px wide, or 1400 px for three or more columns, with at most 64 panels. Axes
/// have labels at the left and the bottom; every panel has ticks. The same input gives the same
/// bytes.
/// @throws InvalidInput  a series has arrays of different lengths, there is no panel, or there are
///                       more than 64
/// @throws WorkerDied    as draw_modes
void draw_plot(const PictureFile& png, const Plot& plot);

}  // namespace chladni::io
