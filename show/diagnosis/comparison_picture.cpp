// Pictures of a comparison: overlaid responses, MAC, errors of the responses.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "io/plot.h"
#include "show/comparison.h"
#include "show/identification/response_curves.h"
#include "show/identification/response_series.h"

namespace chladni::show {
namespace {

constexpr std::size_t kMostPanels = 24;
constexpr int kBlue = 1, kVermilion = 2, kGrey = 6;

io::PlotSeries line(const std::string& name, const Eigen::VectorXd& x, const Eigen::VectorXd& y,
                    int colour) {
  return {.name = name,
          .x = x,
          .y = y,
          .upper = {},
          .style = io::PlotSeries::Style::line,
          .colour = colour,
          .width = 1.4};
}

// Adds the measured response with its uncertainty band.
void add_measured(const modal::FrfSet& measured, Eigen::Index i, Eigen::Index j,
                  io::PlotPanel& panel) {
  const Eigen::VectorXd size = response(measured.value, i, j).cwiseAbs();
  if (!measured.variance.empty()) {
    Eigen::VectorXd half(size.size());
    for (Eigen::Index k = 0; k < size.size(); ++k) {
      half(k) = kBandAlong * std::sqrt(measured.variance[static_cast<std::size_t>(k)](i, j));
    }
    panel.series.push_back({.name = "95 % band",
                            .x = measured.frequency_hz,
                            .y = (size - half).cwiseMax(1e-3 * size),
                            .upper = size + half,
                            .style = io::PlotSeries::Style::band,
                            .colour = kGrey});
  }
  panel.series.push_back({.name = "measured",
                          .x = measured.frequency_hz,
                          .y = size,
                          .upper = {},
                          .style = io::PlotSeries::Style::dots,
                          .colour = kGrey,
                          .width = 0.0});
}

double error(const modal::FrfSet& measured, const std::vector<Eigen::MatrixXcd>& simulated,
             Eigen::Index i, Eigen::Index j) {
  double wrong = 0.0;
  double size = 0.0;
  for (std::size_t k = 0; k < simulated.size(); ++k) {
    const auto value = measured.value[k](i, j);
    if (!std::isfinite(std::abs(value))) continue;
    wrong += std::norm(value - simulated[k](i, j));
    size += std::norm(value);
  }
  return size > 0.0 ? wrong / size : -1.0;
}

// The responses with the largest errors, in their original order: i·q + j.
std::vector<Eigen::Index> shown(const modal::FrfSet& measured,
                                const std::vector<Eigen::MatrixXcd>& simulated) {
  const auto q = measured.input_count();
  std::vector<Eigen::Index> all;
  Eigen::VectorXd errors(measured.output_count() * q);
  for (Eigen::Index e = 0; e < errors.size(); ++e) {
    errors(e) = error(measured, simulated, e / q, e % q);
    if (errors(e) >= 0.0) all.push_back(e);
  }
  std::stable_sort(all.begin(), all.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return errors(a) > errors(b); });
  all.resize(std::min(all.size(), kMostPanels));
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<std::string> frequencies(const std::vector<double>& hz) {
  std::vector<std::string> names;
  for (const double f : hz) names.push_back(fmt::format("{:.4g} Hz", f));
  return names;
}

std::string label_of(const modal::FrfSet& measured, Eigen::Index i, Eigen::Index j) {
  return response_label(measured.outputs[static_cast<std::size_t>(i)],
                        measured.inputs[static_cast<std::size_t>(j)]);
}

}  // namespace

void draw_responses(const io::PictureFile& png, const modal::FrfSet& measured,
                    const std::vector<Eigen::MatrixXcd>& before,
                    const std::vector<Eigen::MatrixXcd>& after,
                    const std::function<bool(Eigen::Index i, Eigen::Index j)>& seen) {
  require(before.size() == measured.value.size() &&
              (after.empty() || after.size() == measured.value.size()),
          "responses over each other: measured and simulated lines differ in number");
  const auto& f = measured.frequency_hz;
  const bool wide = f(0) > 0.0 && f(f.size() - 1) > 5.0 * f(0);
  io::Plot plot{.title = "Measured and simulated responses", .panels = {}, .columns = 0};
  for (const auto e : shown(measured, before)) {
    const auto i = e / measured.input_count();
    const auto j = e % measured.input_count();
    io::PlotPanel panel;
    panel.title = response_name(measured, i, j) + (seen && !seen(i, j) ? ", held out" : "");
    panel.x = {.label = "frequency [Hz]", .logarithmic = wide};
    panel.y = {.label = label_of(measured, i, j), .logarithmic = true};
    add_measured(measured, i, j, panel);
    panel.series.push_back(line("simulated", f, response(before, i, j).cwiseAbs(), kVermilion));
    if (!after.empty()) {
      panel.series.push_back(line("with the causes", f, response(after, i, j).cwiseAbs(), kBlue));
    }
    range_by_curves(panel);
    plot.panels.push_back(std::move(panel));
  }
  require(!plot.panels.empty(), "responses over each other: nothing was measured");
  io::draw_plot(png, plot);
}

io::Curves compared_responses(const modal::FrfSet& measured,
                              const std::vector<Eigen::MatrixXcd>& before,
                              const std::vector<Eigen::MatrixXcd>& after,
                              const std::function<bool(Eigen::Index i, Eigen::Index j)>& seen,
                              std::size_t bytes) {
  std::vector<Prediction> predictions{{"simulated", kVermilion}};
  if (!after.empty()) predictions.push_back({"with the causes", kBlue});
  std::vector<OneResponse> all;
  std::vector<std::string> labels;
  for (Eigen::Index e = 0; e < measured.output_count() * measured.input_count(); ++e) {
    const auto i = e / measured.input_count(), j = e % measured.input_count();
    OneResponse one{response_name(measured, i, j) + (seen && !seen(i, j) ? ", held out" : ""),
                    response(measured.value, i, j),
                    {},
                    {response(before, i, j)}};
    if (!after.empty()) one.predicted.push_back(response(after, i, j));
    if (!measured.variance.empty()) {
      one.deviation.resize(measured.line_count());
      for (Eigen::Index k = 0; k < measured.line_count(); ++k) {
        one.deviation(k) = std::sqrt(measured.variance[static_cast<std::size_t>(k)](i, j));
      }
    }
    all.push_back(std::move(one));
    labels.push_back(label_of(measured, i, j));
  }
  const auto label = common_label(labels, all);
  return response_curves(measured.frequency_hz, predictions, std::move(all), label, bytes);
}

io::MatrixPicture mac_picture(const diagnosis::Comparison& comparison) {
  const auto& modes = comparison.modes;
  return {.title = "MAC of simulated and measured modes, each shape by itself",
          .row_label = "simulated",
          .column_label = "measured",
          .rows = frequencies(modes.simulated_hz),
          .columns = frequencies(modes.measured_hz),
          .value = modes.mac};
}

void draw_mac(const io::PictureFile& png, const diagnosis::Comparison& comparison) {
  if (comparison.modes.mac.size() > 0) io::draw_matrix(png, mac_picture(comparison));
}

io::MatrixPicture errors_picture(const diagnosis::Comparison& comparison) {
  const auto& r = comparison.responses;
  const Eigen::MatrixXd in_percent = 100.0 * r.error;
  double largest = -1.0;  // no error is known
  for (const double one : in_percent.reshaped()) {
    if (std::isfinite(one)) largest = std::max(largest, one);
  }
  const bool all_known = in_percent.allFinite();
  return {.title = std::string("Error of each response, % of its size") +
                   (all_known ? "" : "; empty: not known"),
          .row_label = "sensor",
          .column_label = "actuator",
          .rows = r.outputs,
          .columns = r.inputs,
          .value = in_percent,
          .dark = largest > 0.0 ? largest : 1.0,
          .decimals = largest < 10.0 ? 1 : 0};
}

void draw_errors(const io::PictureFile& png, const diagnosis::Comparison& comparison) {
  io::draw_matrix(png, errors_picture(comparison));
}

}  // namespace chladni::show
