// predicted.png: predicted responses at sensors outside the fit, over the measured ones.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "io/plot.h"
#include "modal/frf_set.h"
#include "show/identification/response_series.h"
#include "show/interpolation.h"
#include "steps/interpolation.h"

namespace chladni::show {
namespace {

constexpr std::size_t kMostRows = 24;
constexpr int kBlue = 1, kGrey = 6;

Eigen::VectorXd deviation(const modal::FrfSet& set, Eigen::Index i, Eigen::Index j) {
  Eigen::VectorXd result(set.line_count());
  for (Eigen::Index k = 0; k < result.size(); ++k) {
    result(k) = std::sqrt(set.variance[static_cast<std::size_t>(k)](i, j));
  }
  return result;
}

// Prediction at output i by input j, over the measured output `row`; −1: not measured.
io::PlotPanel panel_of(const modal::FrfSet& predicted, Eigen::Index i, Eigen::Index j,
                       const modal::FrfSet& measured, Eigen::Index row) {
  const auto& x = predicted.frequency_hz;
  const Eigen::VectorXd size = response(predicted.value, i, j).cwiseAbs();
  const Eigen::VectorXd half = kBandAlong * deviation(predicted, i, j);
  io::PlotPanel panel;
  panel.title = predicted.outputs[static_cast<std::size_t>(i)].name + " by " +
                predicted.inputs[static_cast<std::size_t>(j)].name +
                (half.hasNaN() ? ", band not known" : "");
  panel.x = {.label = "frequency [Hz]", .logarithmic = x(x.size() - 1) > 5.0 * x(0)};
  panel.y = {.label = receptance_label(predicted.inputs[static_cast<std::size_t>(j)]),
             .logarithmic = true};
  panel.series.push_back({.name = "95 % band of the prediction",
                          .x = x,
                          .y = (size - half).cwiseMax(1e-3 * size),
                          .upper = size + half,
                          .style = io::PlotSeries::Style::band,
                          .colour = kBlue});
  if (row >= 0) {
    panel.series.push_back({.name = "measured, seen by no fit",
                            .x = measured.frequency_hz,
                            .y = response(measured.value, row, j).cwiseAbs(),
                            .upper = {},
                            .style = io::PlotSeries::Style::dots,
                            .colour = kGrey,
                            .width = 0.0});
  }
  panel.series.push_back({.name = "predicted",
                          .x = x,
                          .y = size,
                          .upper = {},
                          .style = io::PlotSeries::Style::line,
                          .colour = kBlue,
                          .width = 1.2});
  panel.y.low = 0.3 * size.minCoeff();
  panel.y.high = 2.0 * size.maxCoeff();
  return panel;
}

}  // namespace

std::string predictions_picture(const std::string& file) {
  return std::filesystem::path(file).stem().string() + ".png";
}

void draw_predictions(const steps::IdentifiedModel& model, const modal::FrfSet& predicted,
                      const io::PictureFile& png) {
  const auto& lines = predicted.frequency_hz;
  std::vector<Eigen::Index> rows(model.measured.all.outputs.size());
  std::iota(rows.begin(), rows.end(), 0);
  const auto measured =
      modal::converted(modal::band(modal::part(model.measured.all, rows, model.measured.inputs),
                                   lines(0), lines(lines.size() - 1)),
                       modal::FrfKind::receptance);
  io::Plot plot{.title = "Responses where no fit saw a sensor", .panels = {}, .columns = 0};
  plot.columns = static_cast<int>(std::min<Eigen::Index>(predicted.input_count(), 4));
  for (Eigen::Index i = 0; i < predicted.output_count(); ++i) {
    const auto row =
        steps::index_of(measured.outputs, predicted.outputs[static_cast<std::size_t>(i)].name);
    for (Eigen::Index j = 0; j < predicted.input_count(); ++j) {
      if (plot.panels.size() == kMostRows) break;
      plot.panels.push_back(panel_of(predicted, i, j, measured, row));
    }
  }
  io::draw_plot(png, plot);
}

}  // namespace chladni::show
