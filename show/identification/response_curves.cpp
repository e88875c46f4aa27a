#include "show/identification/response_curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/error.h"
#include "base/percent.h"
#include "show/identification/response_series.h"

namespace chladni::show {
namespace {

using Index = Eigen::Index;
using Style = io::PlotSeries::Style;

constexpr Index kMostShownLines = 1500;
constexpr std::size_t kFewestChoices = 4;
constexpr int kGreyDots = 6;

// The mean of the logarithms of the responses at each line; NaN where all are 0 or not measured.
Eigen::VectorXd levels_of(const std::vector<OneResponse>& responses, Index lines) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(lines);
  Eigen::VectorXd count = Eigen::VectorXd::Zero(lines);
  for (const auto& one : responses) {
    for (Index k = 0; k < lines; ++k) {
      const double size = std::abs(one.measured(k));
      if (!(size > 0.0) || !std::isfinite(size)) continue;
      sum(k) += std::log(size);
      count(k) += 1.0;
    }
  }
  return sum.cwiseQuotient(count);
}

// The lines that are shown: of each bucket those of the largest and the smallest response, so that
// resonances and antiresonances stay.
std::vector<Index> told_lines(const std::vector<OneResponse>& responses, Index lines) {
  std::vector<Index> told(static_cast<std::size_t>(lines));
  std::iota(told.begin(), told.end(), 0);
  if (lines <= kMostShownLines) return told;
  const auto level = levels_of(responses, lines);
  told.clear();
  const Index buckets = kMostShownLines / 2;
  for (Index b = 0; b < buckets; ++b) {
    const Index from = b * lines / buckets;
    Index low = -1, high = -1;
    for (Index k = from; k < (b + 1) * lines / buckets; ++k) {
      if (std::isnan(level(k))) continue;
      if (low < 0 || level(k) < level(low)) low = k;
      if (high < 0 || level(k) > level(high)) high = k;
    }
    told.push_back(low < 0 ? from : std::min(low, high));
    if (low != high) told.push_back(std::max(low, high));
  }
  return told;
}

Eigen::VectorXd degrees(const Eigen::VectorXcd& values) {
  return values.unaryExpr([](const auto& v) { return std::arg(v) * 180.0 / std::numbers::pi; })
      .real();
}

// The arrays of the three panes, in the order of `panes_of`.
io::Curves::Choice choice_of(const OneResponse& one, double error) {
  const Eigen::VectorXd size = one.measured.cwiseAbs();
  Eigen::VectorXd low, high, noise;
  if (one.deviation.size() > 0) {
    const Eigen::VectorXd half = kBandAlong * one.deviation;
    low = (size - half).cwiseMax(1e-3 * size);
    high = size + half;
    noise = 100.0 * one.deviation.cwiseQuotient(size);
  }
  io::Curves::Choice choice{one.name, {low, high, size}};
  if (std::isfinite(error)) choice.name += ", off by " + percent(error);
  for (const auto& values : one.predicted) choice.y.emplace_back(values.cwiseAbs());
  choice.y.push_back(degrees(one.measured));
  for (const auto& values : one.predicted) choice.y.push_back(degrees(values));
  choice.y.push_back(noise);
  for (const auto& values : one.predicted) {
    choice.y.emplace_back(100.0 * (one.measured - values).cwiseAbs().cwiseQuotient(size));
  }
  return choice;
}

std::vector<io::Curves::Pane> panes_of(const std::vector<Prediction>& predictions,
                                       const std::string& label) {
  io::Curves::Pane size, phase, error;
  size.axis = {.label = label, .logarithmic = true};
  size.series = {{"95 % band", Style::band, kGreyDots}, {"measured", Style::dots, kGreyDots}};
  phase.axis = {.label = "phase [deg]", .low = -180.0, .high = 180.0};
  phase.series = {{"measured", Style::dots, kGreyDots}};
  phase.ticks = {-180.0, -90.0, 0.0, 90.0, 180.0};
  error.axis = {.label = "off by [%]", .logarithmic = true};
  error.series = {{"noise", Style::dots, kGreyDots}};
  phase.height = 0.4;
  error.height = 0.5;
  phase.coarse = error.coarse = true;
  for (const auto& [name, colour] : predictions) {
    size.series.push_back({name, Style::line, colour});
    phase.series.push_back({name, Style::line, colour});
    error.series.push_back({name, Style::line, colour});
  }
  return {size, phase, error};
}

// Bytes of one choice in the page: two per value of the magnitude, one of the others, as base64.
std::size_t bytes_of(Index lines, std::size_t predictions) {
  return static_cast<std::size_t>(lines) * (2 * (3 + predictions) + 2 * (1 + predictions)) * 4 / 3;
}

void keep_lines(const std::vector<Index>& told, OneResponse& one) {
  one.measured = one.measured(told).eval();
  if (one.deviation.size() > 0) one.deviation = one.deviation(told).eval();
  for (auto& values : one.predicted) values = values(told).eval();
}

io::PlotAxis frequency_axis(const Eigen::VectorXd& frequency_hz) {
  const double first = frequency_hz(0), last = frequency_hz(frequency_hz.size() - 1);
  return {.label = "frequency [Hz]", .logarithmic = first > 0.0 && last > 5.0 * first};
}

// The errors in descending order, with the responses they belong to.
std::vector<std::pair<double, std::size_t>> by_error(const std::vector<OneResponse>& responses) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t r = 0; r < responses.size(); ++r) {
    const auto& one = responses[r];
    order.emplace_back(one.predicted.empty() ? 0.0 : relative_error(one.measured, one.predicted[0]),
                       r);
  }
  std::erase_if(order, [](const auto& one) { return !std::isfinite(one.first); });
  std::ranges::stable_sort(order, std::greater<>(), &std::pair<double, std::size_t>::first);
  return order;
}

}  // namespace

double relative_error(const Eigen::VectorXcd& measured, const Eigen::VectorXcd& predicted) {
  double wrong = 0.0, size = 0.0;
  for (Index k = 0; k < measured.size(); ++k) {
    if (!std::isfinite(std::abs(measured(k)))) continue;
    wrong += std::norm(measured(k) - predicted(k));
    size += std::norm(measured(k));
  }
  return size > 0.0 ? std::sqrt(wrong / size) : std::numeric_limits<double>::quiet_NaN();
}

std::string common_label(const std::vector<std::string>& labels,
                         std::vector<OneResponse>& responses) {
  const auto unit_of = [](const std::string& label) {
    return std::min(label.find(" ["), label.size());
  };
  const auto& first = labels.front();
  if (std::ranges::count(labels, first) == std::ssize(labels)) return first;
  for (std::size_t r = 0; r < responses.size(); ++r) {
    responses[r].name += labels[r].substr(unit_of(labels[r]));
  }
  return first.substr(0, unit_of(first));
}

io::Curves response_curves(const Eigen::VectorXd& frequency_hz,
                           const std::vector<Prediction>& predictions,
                           std::vector<OneResponse> responses, const std::string& label,
                           std::size_t bytes) {
  auto order = by_error(responses);
  require(!order.empty(), "curves of responses: nothing was measured");
  const auto measured = order.size();
  const auto told = told_lines(responses, frequency_hz.size());
  const auto lines = static_cast<Index>(told.size());
  order.resize(
      std::min(measured, std::max(kFewestChoices, bytes / bytes_of(lines, predictions.size()))));
  io::Curves curves;
  curves.name = "responses";
  curves.chooser = "response";
  curves.axis = frequency_axis(frequency_hz);
  curves.x = {frequency_hz(told)};
  curves.panes = panes_of(predictions, label);
  for (const auto& [error, r] : order) {
    keep_lines(told, responses[r]);
    curves.choices.push_back(choice_of(responses[r], error));
  }
  if (order.size() < measured) {
    curves.caption =
        fmt::format("The {} of {} responses that are missed most. ", order.size(), measured);
  }
  if (lines < frequency_hz.size()) {
    curves.caption += fmt::format("{} of {} lines, with all peaks. ", lines, frequency_hz.size());
  }
  return curves;
}

io::Curves curves_of(const io::Plot& plot, const std::string& name, const std::string& chooser) {
  io::Curves curves;
  curves.name = name;
  curves.chooser = chooser;
  require(!plot.panels.empty(), "curves of a plot: there is no panel");
  curves.axis = plot.panels[0].x;
  curves.verticals = plot.panels[0].verticals;
  curves.panes.resize(1);
  curves.panes[0].axis = {.label = plot.panels[0].y.label,
                          .logarithmic = plot.panels[0].y.logarithmic};
  auto& all = curves.panes[0].series;
  const auto find = [&](const std::string& wanted) {
    return std::ranges::find(all, wanted, &io::Curves::Series::name);
  };
  for (const auto& panel : plot.panels) {
    for (const auto& one : panel.series) {
      if (const auto known = find(one.name); known != all.end()) {
        const auto& x = curves.x[known->x];
        require(x.size() == one.x.size() && x == one.x,
                "curves of a plot: \"" + one.name + "\" has two grids");
        continue;
      }
      all.push_back({one.name, one.style, one.colour, curves.x.size()});
      curves.x.push_back(one.x);
    }
  }
  for (const auto& panel : plot.panels) {
    io::Curves::Choice choice{panel.title, {}};
    for (const auto& series : all) {
      const auto one = std::ranges::find(panel.series, series.name, &io::PlotSeries::name);
      const bool there = one != panel.series.end();
      choice.y.push_back(there ? one->y : Eigen::VectorXd());
      if (series.style == Style::band) choice.y.push_back(there ? one->upper : Eigen::VectorXd());
    }
    curves.choices.push_back(std::move(choice));
  }
  return curves;
}

}  // namespace chladni::show
