#include "io/plot.h"

#include <gtest/gtest.h>
#include <unistd.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "base/draw.h"
#include "base/error.h"
#include "host/atomic_file.h"
#include "io/figure/plot_axis.h"

namespace chladni::io {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> words_of(const PlotAxis& axis, double pixels, double between) {
  std::vector<std::string> words;
  for (const auto& tick : plot_ticks(axis, pixels, between)) {
    if (!tick.words.empty())
      words.push_back(tick.words + (tick.exponent.empty() ? "" : "^") + tick.exponent);
  }
  return words;
}

using PlotWords = std::vector<std::string>;

TEST(PlotAxis, LinearStepsAreOneTwoOrFive) {
  EXPECT_EQ(words_of({.label = "", .low = 0.0, .high = 1.0}, 300.0, 60.0),
            (PlotWords{"0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
  EXPECT_EQ(words_of({.label = "", .low = -3.0, .high = 12.0}, 300.0, 80.0),
            (PlotWords{"0", "5", "10"}));
  EXPECT_EQ(words_of({.label = "", .low = 99.7, .high = 100.3}, 200.0, 60.0),
            (PlotWords{"99.8", "100.0", "100.2"}));
  EXPECT_EQ(words_of({.label = "", .low = 0.0, .high = 4e-6}, 200.0, 60.0),
            (PlotWords{"0", "2.0e-06", "4.0e-06"}));
}

TEST(PlotAxis, LogarithmicTicksAreDecades) {
  EXPECT_EQ(words_of({.label = "", .logarithmic = true, .low = 1.0, .high = 1000.0}, 300.0, 60.0),
            (PlotWords{"1", "10", "100", "1000"}));
  EXPECT_EQ(words_of({.label = "", .logarithmic = true, .low = 1e-9, .high = 1e-6}, 300.0, 60.0),
            (PlotWords{"10^\xE2\x88\x92"
                       "9",
                       "10^\xE2\x88\x92"
                       "8",
                       "10^\xE2\x88\x92"
                       "7",
                       "10^\xE2\x88\x92"
                       "6"}));
  EXPECT_EQ(words_of({.label = "", .logarithmic = true, .low = 1.0, .high = 100.0}, 900.0, 60.0),
            (PlotWords{"1", "2", "5", "10", "20", "50", "100"}));
  EXPECT_EQ(
      words_of({.label = "", .logarithmic = true, .low = 1e-12, .high = 1.0}, 100.0, 30.0).size(),
      4U);
}

TEST(PlotAxis, TicksLieInsideAndApart) {
  Draw draw(4);
  for (int trial = 0; trial < 2000; ++trial) {
    PlotAxis axis;
    axis.logarithmic = trial % 2 == 1;
    const double scale = std::pow(10.0, 12.0 * draw.uniform() - 6.0);
    axis.low = axis.logarithmic ? scale : scale * draw.normal();
    axis.high = axis.logarithmic ? scale * std::pow(10.0, 8.0 * draw.uniform() + 0.01)
                                 : axis.low + scale * draw.uniform() + 1e-3 * scale;
    const double pixels = 200.0 + 800.0 * draw.uniform();
    double before = -1e9;
    int count = 0;
    for (const auto& tick : plot_ticks(axis, pixels, 60.0)) {
      const double at = along(axis, tick.value);
      EXPECT_GE(at, -1e-6);
      EXPECT_LE(at, 1.0 + 1e-6);
      if (tick.words.empty()) continue;
      ++count;
      EXPECT_TRUE(axis.logarithmic || (at - before) * pixels > 40.0)
          << axis.low << " " << axis.high;
      before = at;
    }
    EXPECT_GE(count, axis.logarithmic && axis.high < 10.0 * axis.low ? 0 : 1);
    EXPECT_LT(count, 30);
  }
}

TEST(PlotAxis, RangeHoldsTheValues) {
  const auto linear = ranged({}, {3.0, std::nan(""), -1.0}, 0.05);
  EXPECT_DOUBLE_EQ(linear.low, -1.2);
  EXPECT_DOUBLE_EQ(linear.high, 3.2);
  PlotAxis log;
  log.logarithmic = true;
  const auto decades = ranged(log, {0.0, -3.0, 1.0, 100.0}, 0.0);
  EXPECT_NEAR(decades.low, 1.0, 1e-12);
  EXPECT_NEAR(decades.high, 100.0, 1e-9);
  EXPECT_TRUE(std::isnan(along(decades, 0.0)));
  EXPECT_NEAR(along(decades, 10.0), 0.5, 1e-12);
  for (const auto& values : {std::vector<double>{}, {5.0}, {0.0}, {-2.0}}) {
    EXPECT_LT(ranged({}, values, 0.05).low, ranged({}, values, 0.05).high);
    EXPECT_LT(ranged(log, values, 0.05).low, ranged(log, values, 0.05).high);
  }
}

class PlotPicture : public testing::Test {
 protected:
  ~PlotPicture() override { fs::remove(png_); }
  fs::path png_ =
      fs::temp_directory_path() / ("chladni_plot_" + std::to_string(::getpid()) + ".png");
};

struct PlotCounts {
  int width = 0, height = 0, blue = 0, red = 0;
};

PlotCounts plot_counts(const fs::path& png) {
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName(png.c_str());
  reader->Update();
  vtkImageData* image = reader->GetOutput();
  PlotCounts counts{image->GetDimensions()[0], image->GetDimensions()[1]};
  const auto* pixel = static_cast<const unsigned char*>(image->GetScalarPointer());
  for (int i = 0; i < counts.width * counts.height; ++i, pixel += 3) {
    counts.blue += pixel[2] > pixel[0] + 100;
    counts.red += pixel[0] > pixel[2] + 100;
  }
  return counts;
}

Plot plot_of(PlotSeries::Style style, int colour) {
  PlotSeries series;
  series.name = "curve";
  series.x = Eigen::VectorXd::LinSpaced(200, 1.0, 100.0);
  series.y = series.x.array().square();
  series.upper = 3.0 * series.y;
  series.style = style;
  series.colour = colour;
  Plot plot;
  plot.title = "a plot";
  plot.panels.resize(1);
  plot.panels[0].series.push_back(series);
  plot.panels[0].x.logarithmic = plot.panels[0].y.logarithmic = true;
  return plot;
}

TEST_F(PlotPicture, EveryStyleLeavesItsColour) {
  using Style = PlotSeries::Style;
  for (const auto style :
       {Style::line, Style::dashed, Style::dots, Style::circles, Style::crosses, Style::plusses}) {
    draw_plot(png_, plot_of(style, 1));
    const auto blue = plot_counts(png_);
    EXPECT_EQ(blue.width, 1000);
    EXPECT_GT(blue.blue, 500) << static_cast<int>(style);
    EXPECT_EQ(blue.red, 0) << static_cast<int>(style);
  }
  draw_plot(png_, plot_of(Style::line, 2));
  EXPECT_EQ(plot_counts(png_).blue, 0);
  EXPECT_GT(plot_counts(png_).red, 500);
}

TEST_F(PlotPicture, WhatLiesOutsideTheAxesIsNotDrawn) {
  auto plot = plot_of(PlotSeries::Style::line, 1);
  draw_plot(png_, plot);
  const int whole = plot_counts(png_).blue;
  plot.panels[0].y.low = 1e6;
  plot.panels[0].y.high = 1e7;
  plot.panels[0].series[0].name.clear();
  draw_plot(png_, plot);
  EXPECT_EQ(plot_counts(png_).blue, 0);
  plot.panels[0].y.low = 1e2;
  plot.panels[0].y.high = 1e3;
  draw_plot(png_, plot);
  EXPECT_GT(plot_counts(png_).blue, 100);
  EXPECT_LT(plot_counts(png_).blue, whole);
}

TEST_F(PlotPicture, TheSameInputGivesTheSameBytes) {
  draw_plot(png_, plot_of(PlotSeries::Style::dots, 1));
  const auto first = read_whole(png_);
  draw_plot(png_, plot_of(PlotSeries::Style::dots, 1));
  EXPECT_TRUE(read_whole(png_) == first);
}

// Numbers of the attribute `name` in all elements, in their order.
std::vector<std::string> attributes(const std::string& svg, const std::string& name) {
  std::vector<std::string> values;
  const std::string key = " " + name + "=\"";
  for (auto at = svg.find(key); at != std::string::npos; at = svg.find(key, at + 1)) {
    const auto from = at + key.size();
    values.push_back(svg.substr(from, svg.find('"', from) - from));
  }
  return values;
}

std::string svg_of(const Plot& plot, const fs::path& png) {
  draw_plot({png, nullptr, true}, plot);
  auto svg_file = png;
  svg_file.replace_extension(".svg");
  const auto svg = read_whole(svg_file);
  fs::remove(svg_file);
  return svg;
}

TEST_F(PlotPicture, LeavesItsVectorsWhereTheyAreWanted) {
  const auto plot = plot_of(PlotSeries::Style::line, 2);
  draw_plot(png_, plot);
  auto svg_file = png_;
  EXPECT_FALSE(fs::exists(svg_file.replace_extension(".svg")));
  const auto svg = svg_of(plot, png_);
  EXPECT_TRUE(fs::exists(png_));
  EXPECT_EQ(svg, svg_of(plot, png_));
  EXPECT_TRUE(svg.starts_with("<?xml"));
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  EXPECT_NE(svg.find(">a plot</text>"), std::string::npos);
  EXPECT_NE(svg.find(">curve</text>"), std::string::npos);
  const auto strokes = attributes(svg, "stroke");
  EXPECT_NE(std::ranges::find(strokes, "#d65e00"), strokes.end());  // vermilion
}

// On logarithmic axes x² is a straight line: its first and last places tell all others.
TEST_F(PlotPicture, VectorsLieWhereTheValuesAre) {
  const auto svg = svg_of(plot_of(PlotSeries::Style::line, 2), png_);
  const auto strokes = attributes(svg, "stroke");
  const auto paths = attributes(svg, "d");
  ASSERT_EQ(strokes.size(), paths.size());
  std::string longest;
  for (std::size_t p = 0; p < paths.size(); ++p) {
    if (strokes[p] == "#d65e00" && paths[p].size() > longest.size()) longest = paths[p];
  }
  std::vector<Eigen::Vector2d> places;
  std::ranges::replace(longest, 'M', ' ');
  std::ranges::replace(longest, 'L', ' ');
  std::istringstream numbers(longest);
  for (Eigen::Vector2d place; numbers >> place.x() >> place.y();) places.push_back(place);
  ASSERT_GE(places.size(), 2U);
  const Eigen::Vector2d along = places.back() - places.front();
  EXPECT_GT(along.x(), 500.0);
  EXPECT_LT(along.y(), -300.0);  // upwards
  for (const auto& place : places) {
    const Eigen::Vector2d from = place - places.front();
    EXPECT_NEAR(from.x() * along.y() - from.y() * along.x(), 0.0, 0.02 * along.norm());
  }
}

// Each of two units side by side has its own label; one that both have stands at the left alone.
TEST_F(PlotPicture, APanelIsLabelledWhereItsAxisIsNotItsNeighbours) {
  auto plot = plot_of(PlotSeries::Style::line, 1);
  plot.columns = 2;
  plot.panels.push_back(plot.panels[0]);
  plot.panels[0].y.label = "by force";
  const auto times = [&](const std::string& second) {
    plot.panels[1].y.label = second;
    const auto svg = svg_of(plot, png_);
    int count = 0;
    for (auto at = svg.find(">" + second + "<"); at != svg.npos;
         at = svg.find(">" + second + "<", at + 1)) {
      ++count;
    }
    return count;
  };
  EXPECT_EQ(times("by force"), 1);
  EXPECT_EQ(times("by voltage"), 1);
}

TEST_F(PlotPicture, WordsOfVectorsAreNoMarkup) {
  auto plot = plot_of(PlotSeries::Style::line, 1);
  plot.title = "a < b & \"c\"\n> d";
  const auto svg = svg_of(plot, png_);
  EXPECT_NE(svg.find("a &lt; b &amp; &quot;c&quot; &gt; d</text>"), std::string::npos);
  plot.title =
      "Gr\xF6\xDF"
      "e";  // Latin-1, as files of instruments have names
  EXPECT_NE(svg_of(plot, png_)
                .find("Gr\xEF\xBF\xBD\xEF\xBF\xBD"
                      "e</text>"),
            std::string::npos);
}

TEST_F(PlotPicture, RefusesWhatCannotBeDrawn) {
  auto plot = plot_of(PlotSeries::Style::line, 1);
  plot.panels[0].series[0].y.conservativeResize(7);
  EXPECT_THROW(draw_plot(png_, plot), InvalidInput);
  EXPECT_THROW(draw_plot(png_, {}), InvalidInput);
}

}  // namespace
}  // namespace chladni::io
