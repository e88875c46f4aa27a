// Curves of the report, as data.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "io/plot.h"

namespace chladni::io {

/// Curves that the reader zooms, over common lines. One choice is seen at a time, its panes below
/// each other. Styles and colours are those of PlotSeries.
struct Curves {
  struct Series {
    std::string name;
    PlotSeries::Style style = PlotSeries::Style::line;
    int colour = 1;
    std::size_t x = 0;  ///< index into `x`
  };
  struct Pane {
    PlotAxis axis;  ///< low, high: fixed range, if they differ
    std::vector<Series> series;
    double height = 1.0;  ///< 1: 300 px
    bool coarse = false;  ///< values in 254 steps instead of 65 534 over the range of the pane
    std::vector<double> ticks;  ///< empty: found by the page
  };
  struct Choice {
    std::string name;  ///< "s1 by a1, off by 5.1 %"
    /// Arrays of the series of all panes in turn, as long as their x; a band has two, the lower
    /// edge first. An empty one is not drawn. A value that is not finite, or not above 0 on a
    /// logarithmic axis, is a gap.
    std::vector<Eigen::VectorXd> y;
  };
  std::string name;     ///< of saved files: "responses"
  std::string chooser;  ///< what is chosen: "response"
  std::string caption;
  PlotAxis axis;  ///< of x
  std::vector<Eigen::VectorXd> x;
  std::vector<Pane> panes;
  std::vector<Choice> choices;
  std::vector<double> verticals;  ///< x of thin dashed lines
};

}  // namespace chladni::io
