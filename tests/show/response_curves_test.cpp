// Curves of the report: what is shown of many responses, and that their numbers are the responses'.
#include "show/identification/response_curves.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "base/error.h"
#include "show/identification.h"
#include "show/identification/response_series.h"

namespace chladni::show {
namespace {

using Complex = std::complex<double>;

Eigen::VectorXd lines(Eigen::Index count) {
  return Eigen::VectorXd::LinSpaced(count, 10.0, 1000.0);
}

// A response of one resonance at 300 Hz, and a prediction that is `factor` times as large.
OneResponse resonance(const std::string& name, Eigen::Index count, Complex factor) {
  OneResponse one;
  one.name = name;
  one.measured =
      (1.0 / (1.0 + Complex(0.0, 0.02) - (lines(count).array() / 300.0).square())).matrix();
  one.predicted = {factor * one.measured};
  return one;
}

TEST(ResponseCurves, TellMagnitudePhaseAndErrorOfEachResponse) {
  auto one = resonance("s by a", 40, std::polar(1.1, 0.0));
  one.deviation = 0.02 * one.measured.cwiseAbs();
  const auto curves = response_curves(lines(40), {{"simulated", 2}}, {one}, "receptance [m/N]");
  ASSERT_EQ(curves.choices.size(), 1U);
  EXPECT_EQ(curves.choices[0].name, "s by a, off by 10 %");
  const auto& y = curves.choices[0].y;  // band, measured, simulated; two phases; noise, simulated
  ASSERT_EQ(y.size(), 8U);
  const Eigen::VectorXd size = one.measured.cwiseAbs();
  EXPECT_LT((y[2] - size).norm(), 1e-14 * size.norm());
  EXPECT_LT((y[3] - 1.1 * size).norm(), 1e-14 * size.norm());
  // 95 % of a circular error of variance 1 lie within 1.96/√2 along the radius.
  EXPECT_LT((y[1] - y[0] - 2.0 * 1.96 / std::sqrt(2.0) * one.deviation).norm(), 1e-4 * size.norm());
  EXPECT_LT((y[4] - y[5]).cwiseAbs().maxCoeff(), 1e-9) << "a real factor turns no phase";
  EXPECT_NEAR(y[4](39), 180.0 / M_PI * std::arg(one.measured(39)), 1e-9);
  EXPECT_LT((y[6].array() - 2.0).abs().maxCoeff(), 1e-9);
  EXPECT_LT((y[7].array() - 10.0).abs().maxCoeff(), 1e-9);
}

TEST(ResponseCurves, ThoseThatAreMissedMostComeFirst) {
  const auto curves = response_curves(
      lines(40), {{"simulated", 2}},
      {resonance("little", 40, 1.01), resonance("much", 40, 1.5), resonance("some", 40, 1.1)}, "");
  EXPECT_EQ(curves.choices[0].name, "much, off by 50 %");
  EXPECT_EQ(curves.choices[1].name, "some, off by 10 %");
  EXPECT_EQ(curves.choices[2].name, "little, off by 1 %");
}

// The band of what is all noise begins at a thousandth of what was measured.
TEST(ResponseCurves, TheAxisIsThatOfTheCurvesNotOfTheBand) {
  io::PlotPanel panel;
  const Eigen::Vector3d x(1.0, 2.0, 3.0), size(2e-8, 1e-8, 4e-8);
  panel.series.push_back({.name = "95 % band",
                          .x = x,
                          .y = 1e-3 * size,
                          .upper = 50.0 * size,
                          .style = io::PlotSeries::Style::band});
  range_by_curves(panel);
  EXPECT_EQ(panel.y.low, panel.y.high) << "there is no curve";
  panel.series.push_back({.name = "measured", .x = x, .y = size, .upper = {}});
  panel.series.push_back(
      {.name = "simulated", .x = x, .y = Eigen::Vector3d(NAN, 0.0, 6e-8), .upper = {}});
  range_by_curves(panel);
  EXPECT_DOUBLE_EQ(panel.y.low, 0.5e-8);
  EXPECT_DOUBLE_EQ(panel.y.high, 12e-8);
}

TEST(ResponseCurves, SayWhatIsLeftOut) {
  std::vector<OneResponse> many;
  for (int r = 0; r < 30; ++r) many.push_back(resonance("r", 400, 1.0 + 0.01 * r));
  const auto curves = response_curves(lines(400), {{"simulated", 2}}, many, "", 50'000);
  EXPECT_LT(curves.choices.size(), 30U);
  EXPECT_GE(curves.choices.size(), 4U);
  EXPECT_NE(curves.caption.find(" of 30 responses"), std::string::npos);
  EXPECT_EQ(curves.choices[0].name, "r, off by 29 %");
}

TEST(ResponseCurves, OfManyLinesTheResonanceStays) {
  const auto one = resonance("s", 20'000, 1.1);
  const auto curves = response_curves(lines(20'000), {{"simulated", 2}}, {one}, "");
  EXPECT_LE(curves.x[0].size(), 1500);
  EXPECT_EQ(curves.choices[0].y[2].maxCoeff(), one.measured.cwiseAbs().maxCoeff());
  EXPECT_NE(curves.caption.find("of 20000 lines"), std::string::npos);
  EXPECT_TRUE(((curves.x[0].tail(curves.x[0].size() - 1) - curves.x[0].head(curves.x[0].size() - 1))
                   .array() > 0.0)
                  .all());
}

// A number that is not measured is no peak among small ones, as receptances are.
TEST(ResponseCurves, ALineThatIsNotMeasuredHidesNoResonance) {
  auto one = resonance("s", 20'000, 1.1);
  one.measured *= 1e-9;
  one.predicted[0] *= 1e-9;
  Eigen::Index peak = 0;
  const double most = one.measured.cwiseAbs().maxCoeff(&peak);
  one.measured(peak - 1) = std::nan("");
  one.measured(peak + 1) = 0.0;
  const auto curves = response_curves(lines(20'000), {{"simulated", 2}}, {one}, "");
  EXPECT_EQ((curves.x[0].array() == lines(20'000)(peak)).count(), 1) << most;
}

TEST(ResponseCurves, WhatWasNotMeasuredIsLeftOut) {
  auto unmeasured = resonance("none", 40, 1.1);
  unmeasured.measured.setConstant(NAN);
  const auto curves =
      response_curves(lines(40), {{"simulated", 2}}, {unmeasured, resonance("one", 40, 1.1)}, "");
  ASSERT_EQ(curves.choices.size(), 1U);
  EXPECT_EQ(curves.choices[0].name, "one, off by 10 %");
  EXPECT_THROW(static_cast<void>(response_curves(lines(40), {{"simulated", 2}}, {unmeasured}, "")),
               InvalidInput);
}

TEST(ResponseCurves, AUnitThatNotAllHaveStandsBehindEachName) {
  std::vector<OneResponse> two{resonance("s by a", 40, 1.1), resonance("s by coil", 40, 1.1)};
  EXPECT_EQ(common_label({"receptance [m/N]", "receptance [m/N]"}, two), "receptance [m/N]");
  EXPECT_EQ(two[1].name, "s by coil");
  EXPECT_EQ(common_label({"receptance [m/N]", "receptance [m/V]"}, two), "receptance");
  EXPECT_EQ(two[0].name, "s by a [m/N]");
  EXPECT_EQ(two[1].name, "s by coil [m/V]");
}

TEST(ResponseCurves, AResponseHasTheUnitsOfBothItsChannels) {
  modal::MeasuredChannel sensor, coil;
  sensor.unit = "m/s^2";
  coil.unit = "V";
  EXPECT_EQ(response_label(sensor, coil), "|response| [m/s^2/V]");
  EXPECT_EQ(response_label(sensor, {}), "|response| [m/s^2/N]");
  EXPECT_EQ(response_label({}, coil), "|response|");
}

// A cell without a number is no response of 0: the whole fit stood there as its error.
TEST(FitPlot, WhatWasNotMeasuredIsAGap) {
  steps::IdentifiedModel model;
  modal::MeasuredChannel channel;
  channel.name = "s";
  model.seen.outputs = model.seen.inputs = {channel};
  auto& fitted = model.found.fit.model;
  fitted.frequency_hz = Eigen::VectorXd::Constant(1, 300.0);
  fitted.damping_ratio = Eigen::VectorXd::Constant(1, 0.01);
  fitted.output_shapes = fitted.input_shapes = Eigen::MatrixXd::Ones(1, 1);
  fitted.residual = Eigen::MatrixXd::Zero(1, 1);
  auto& data = model.data;
  data.outputs = data.inputs = 1;
  data.frequency_hz = lines(40);
  data.value = 1.01 * identification::responses(model.found.fit, data.frequency_hz);
  data.weight = Eigen::MatrixXd::Ones(40, 1);
  data.value.middleRows(10, 5).setZero();
  data.weight.middleRows(10, 5).setZero();
  const auto plot = fit_plot(model);
  ASSERT_EQ(plot.panels.size(), 1U);
  const auto& panel = plot.panels[0];
  for (const std::size_t s : {0U, 1U}) {  // measured, and measured less fitted
    for (Eigen::Index k = 0; k < 40; ++k) {
      EXPECT_EQ(std::isfinite(panel.series[s].y(k)), k < 10 || k >= 15) << s << " " << k;
    }
  }
  EXPECT_TRUE(panel.series[2].y.allFinite()) << "the fit goes on";
  EXPECT_GT(panel.y.low, 0.0);
  EXPECT_LT(panel.y.low, panel.y.high);
}

io::PlotSeries series(const std::string& name, Eigen::Index count) {
  return {.name = name, .x = lines(count), .y = lines(count), .upper = {}};
}

TEST(ResponseCurves, PanelsOfAPlotAreChoices) {
  io::Plot plot;
  plot.panels.resize(2);
  plot.panels[0].title = "first";
  plot.panels[0].series = {series("a", 5), series("b", 7)};
  plot.panels[1].title = "second";
  plot.panels[1].series = {series("b", 7)};
  const auto curves = curves_of(plot, "two", "panel");
  ASSERT_EQ(curves.choices.size(), 2U);
  EXPECT_EQ(curves.choices[1].name, "second");
  EXPECT_EQ(curves.choices[1].y[0].size(), 0) << "it has no a";
  EXPECT_EQ(curves.choices[1].y[1], lines(7));
  EXPECT_EQ(curves.x[curves.panes[0].series[1].x], lines(7));
  plot.panels[1].series = {series("b", 8)};
  EXPECT_THROW(static_cast<void>(curves_of(plot, "two", "panel")), InvalidInput);
}

}  // namespace
}  // namespace chladni::show
