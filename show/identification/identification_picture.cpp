// fit.png: measured responses, the fit and the residual; the stabilisation diagram.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "base/error.h"
#include "io/plot.h"
#include "show/identification.h"
#include "show/identification/response_curves.h"
#include "show/identification/response_series.h"
#include "steps/identification.h"

namespace chladni::show {
namespace {

constexpr Eigen::Index kMostPanels = 24, kMostValues = 4;
constexpr int kInk = 0, kBlueLine = 1, kVermilion = 2, kGrey = 6;

// The measured response, K; NaN where the fit has no value.
Eigen::VectorXcd measured_of(const identification::FitData& data, Eigen::Index response) {
  const Eigen::VectorXcd value = data.value.col(response);
  return (data.weight.col(response).array() > 0.0)
      .select(value.array(), std::complex<double>(std::nan(""), std::nan("")));
}

io::PlotPanel response_panel(const steps::IdentifiedModel& model, const Eigen::MatrixXcd& fitted,
                             Eigen::Index e) {
  const auto& data = model.data;
  const auto j = static_cast<std::size_t>(e / data.outputs);
  const double wide = data.frequency_hz(data.line_count() - 1) / data.frequency_hz(0);
  io::PlotPanel panel;
  panel.title = response_name(model.seen, e % data.outputs, e / data.outputs);
  panel.x = {.label = "frequency [Hz]", .logarithmic = wide > 5.0};
  panel.y = {.label = receptance_label(model.seen.inputs[j]), .logarithmic = true};
  const Eigen::VectorXcd measured = measured_of(data, e);
  const Eigen::VectorXd size = measured.cwiseAbs();
  panel.series.push_back({.name = "measured",
                          .x = data.frequency_hz,
                          .y = size,
                          .upper = {},
                          .style = io::PlotSeries::Style::dots,
                          .colour = kGrey,
                          .width = 0.0});
  const Eigen::VectorXd left = (measured - fitted.col(e)).cwiseAbs();
  panel.series.push_back({.name = "measured less fitted",
                          .x = data.frequency_hz,
                          .y = left,
                          .upper = {},
                          .style = io::PlotSeries::Style::dots,
                          .colour = kVermilion,
                          .width = 0.0});
  panel.series.push_back({.name = "fitted",
                          .x = data.frequency_hz,
                          .y = fitted.col(e).cwiseAbs(),
                          .upper = {},
                          .style = io::PlotSeries::Style::line,
                          .colour = kInk,
                          .width = 1.2});
  const double largest = size.maxCoeff<Eigen::PropagateNumbers>();
  panel.y.low = std::max(1e-6 * largest, 0.1 * left.minCoeff<Eigen::PropagateNumbers>());
  panel.y.high = 2.0 * largest;
  return panel;
}

io::PlotPanel stabilisation_panel(const steps::IdentifiedModel& model) {
  io::PlotPanel panel;
  panel.title = "Poles of rising order; dashed: the modes of the fit";
  panel.x = {.label = "frequency [Hz]",
             .low = model.data.frequency_hz(0),
             .high = model.data.frequency_hz(model.data.line_count() - 1)};
  panel.y = {.label = "order"};
  const auto add = [&](const char* name, io::PlotSeries::Style style, int colour, auto wanted) {
    std::vector<double> x;
    std::vector<double> y;
    for (const auto& point : model.stabilisation) {
      if (!wanted(point)) continue;
      x.push_back(point.frequency_hz);
      y.push_back(static_cast<double>(point.order));
    }
    const auto n = static_cast<Eigen::Index>(x.size());
    panel.series.push_back({.name = name,
                            .x = Eigen::Map<const Eigen::VectorXd>(x.data(), n),
                            .y = Eigen::Map<const Eigen::VectorXd>(y.data(), n),
                            .upper = {},
                            .style = style,
                            .colour = colour,
                            .width = 0.0});
  };
  using Style = io::PlotSeries::Style;
  const auto stable = [](const auto& p) { return p.stable_damping && p.stable_shape; };
  add("new", Style::dots, kGrey, [](const auto& p) { return !p.stable_frequency; });
  add("frequency within 0.1 %", Style::crosses, kVermilion,
      [&](const auto& p) { return p.stable_frequency && !stable(p); });
  add("damping within 5 % and MAC above 0.98 too", Style::circles, 3, stable);
  const auto& frequency = model.found.fit.model.frequency_hz;
  panel.verticals.assign(frequency.begin(), frequency.end());
  return panel;
}

// Singular values of the responses at each line: as many are large as modes take part.
io::PlotPanel indicator_panel(const steps::IdentifiedModel& model) {
  const Eigen::MatrixXd values = identification::mode_indicator(model.data);
  io::PlotPanel panel = stabilisation_panel(model);
  panel.title = "Singular values of the responses (mode indicator)";
  panel.y = {.label = "singular value of the " + receptance_label(model.seen.inputs[0]),
             .logarithmic = true};
  panel.series.clear();
  for (Eigen::Index i = 0; i < std::min<Eigen::Index>(values.cols(), kMostValues); ++i) {
    panel.series.push_back({.name = "",
                            .x = model.data.frequency_hz,
                            .y = values.col(i),
                            .upper = {},
                            .style = io::PlotSeries::Style::line,
                            .colour = static_cast<int>(i) + 1,
                            .width = 1.2});
  }
  return panel;
}

}  // namespace

io::Plot fit_plot(const steps::IdentifiedModel& model) {
  const auto& data = model.data;
  const Eigen::MatrixXcd fitted = identification::responses(model.found.fit, data.frequency_hz);
  io::Plot plot{.title = "Measured and fitted responses", .panels = {}, .columns = 0};
  plot.columns = static_cast<int>(std::min<Eigen::Index>(data.inputs, 4));
  for (Eigen::Index i = 0; i < data.outputs; ++i) {
    for (Eigen::Index j = 0; j < data.inputs; ++j) {
      if (static_cast<Eigen::Index>(plot.panels.size()) >= kMostPanels) break;
      const auto e = i + data.outputs * j;
      if (data.weight.col(e).maxCoeff() > 0.0) {
        plot.panels.push_back(response_panel(model, fitted, e));
      }
    }
  }
  return plot;
}

void draw_fit(const steps::IdentifiedModel& model, const io::PictureFile& png) {
  io::draw_plot(png, fit_plot(model));
}

io::Curves fitted_curves(const steps::IdentifiedModel& model, std::size_t bytes) {
  const auto& data = model.data;
  const Eigen::MatrixXcd fitted = identification::responses(model.found.fit, data.frequency_hz);
  std::vector<OneResponse> all;
  std::vector<std::string> labels;
  for (Eigen::Index e = 0; e < data.response_count(); ++e) {
    const Eigen::VectorXd weight = data.weight.col(e);
    if (weight.maxCoeff() <= 0.0) continue;
    OneResponse one{response_name(model.seen, e % data.outputs, e / data.outputs),
                    measured_of(data, e),
                    {},
                    {fitted.col(e)}};
    // A deviation that a model error is part of is no noise.
    if (data.noise_known) {
      one.deviation = (weight.array() > 0.0).select(weight.cwiseInverse().array(), std::nan(""));
    }
    all.push_back(std::move(one));
    const auto j = static_cast<std::size_t>(e / data.outputs);
    labels.push_back(receptance_label(model.seen.inputs[j]));
  }
  require(!all.empty(), "curves of the fit: nothing was measured");
  const auto label = common_label(labels, all);
  return response_curves(data.frequency_hz, {{"fitted", kBlueLine}}, std::move(all), label, bytes);
}

io::Plot stabilisation_plot(const steps::IdentifiedModel& model) {
  return {.title = "Stabilisation diagram",
          .panels = {stabilisation_panel(model)},
          .columns = 1,
          .aspect = 0.6};
}

void draw_stabilisation(const steps::IdentifiedModel& model, const io::PictureFile& png) {
  auto plot = stabilisation_plot(model);
  plot.aspect = 0.45;
  if (std::min(model.data.outputs, model.data.inputs) > 1) {
    plot.panels.push_back(indicator_panel(model));
  }
  io::draw_plot(png, plot);
}

}  // namespace chladni::show
