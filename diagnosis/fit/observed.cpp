#include "diagnosis/observed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/error.h"
#include "base/index.h"
#include "diagnosis/constants.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

// For each name of `wanted` its index in `channels`, or −1.
std::vector<Index> places_of(const std::vector<std::string>& wanted,
                             const std::vector<modal::MeasuredChannel>& channels) {
  std::vector<Index> places;
  for (const auto& name : wanted) {
    const auto found = std::ranges::find(channels, name, &modal::MeasuredChannel::name);
    places.push_back(found == channels.end() ? -1 : found - channels.begin());
  }
  return places;
}

void note_strangers(const std::vector<modal::MeasuredChannel>& channels,
                    const std::vector<std::string>& known, const char* side,
                    std::vector<std::string>& notes) {
  for (const auto& channel : channels) {
    if (std::ranges::find(known, channel.name) != known.end()) continue;
    notes.push_back(
        fmt::format("{} {} is measured, but not in the study: left out", side, channel.name));
  }
}

// The channels that are measured; `places` becomes theirs.
ChannelSide measured_part(const ChannelSide& side, std::vector<Index>& places,
                          std::vector<Index>& kept) {
  std::vector<Index> found;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i] < 0) continue;
    kept.push_back(static_cast<Index>(i));
    found.push_back(places[i]);
  }
  places = found;
  return part_of(side, kept);
}

std::vector<Index> lines_of(const modal::FrfSet& set, double high_hz) {
  std::vector<Index> lines;
  for (Index k = 0; k < set.line_count(); ++k) {
    if (set.frequency_hz(k) > 0.0 && set.frequency_hz(k) <= high_hz) lines.push_back(k);
  }
  require(lines.size() >= kConstants.least_lines,
          fmt::format("{} measured lines between 0 and {:.6g} Hz, where the simulation has modes; "
                      "at least {} are expected",
                      lines.size(), high_hz, kConstants.least_lines));
  return lines;
}

// E[1/s²] σ² of a sample variance s² of ν complex degrees of freedom: ν / (ν − 1). With fewer than
// two it is taken as that of two, since one has no mean.
double inverse_excess(double freedom) {
  if (freedom <= 0.0) return 1.0;  // not known
  const double known = std::max(freedom, 2.0);
  return known / (known - 1.0);
}

void fill(Observed& observed, const modal::FrfSet& set, const std::vector<Index>& lines,
          const std::vector<Index>& rows, const std::vector<Index>& cols) {
  require(!set.variance.empty(), "the measured responses carry no variance");
  const double too_small = inverse_excess(set.averages);
  for (std::size_t n = 0; n < lines.size(); ++n) {
    const auto k = at(lines[n]);
    const auto line = static_cast<Index>(n);
    observed.omega(line) = 2.0 * std::numbers::pi * set.frequency_hz(lines[n]);
    for (std::size_t j = 0; j < cols.size(); ++j) {
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto value = set.value[k](rows[i], cols[j]);
        const double variance = set.variance[k](rows[i], cols[j]);
        const auto column = static_cast<Index>(i) + observed.outputs * static_cast<Index>(j);
        if (!std::isfinite(value.real()) || !std::isfinite(value.imag())) continue;
        require(std::isfinite(variance) && variance > 0.0,
                fmt::format("the variance of {} / {} at {:.6g} Hz is {:.3g}; a positive one is "
                            "expected",
                            set.outputs[at(rows[i])].name, set.inputs[at(cols[j])].name,
                            set.frequency_hz(lines[n]), variance));
        observed.value(line, column) = value;
        observed.weight(line, column) = std::numbers::sqrt2 / std::sqrt(too_small * variance);
      }
    }
  }
}

// Levels of rows and columns whose product is as large as the measured power, in the sum over each
// row and each column. Where all was measured: row sum times column sum over the whole sum.
// Otherwise by proportional fitting, the model of quasi-independence (Goodman, J. Am. Stat. Assoc.
// 63, 1968).
std::pair<Eigen::VectorXd, Eigen::VectorXd> levels_of(const Eigen::MatrixXd& power,
                                                      const Eigen::MatrixXd& known) {
  constexpr int kMostRounds = 10000;  // a chain of levels that are far apart takes thousands
  constexpr double kRounding = 1e-9;  // of a round that changes nothing any more
  const auto over = [](const Eigen::VectorXd& sum, const Eigen::VectorXd& weight) {
    return Eigen::VectorXd((weight.array() > 0.0).select(sum.array() / weight.array(), 0.0));
  };
  Eigen::VectorXd columns = Eigen::VectorXd::Ones(power.cols());
  const Eigen::VectorXd row_sums = power.rowwise().sum();
  const Eigen::VectorXd column_sums = power.colwise().sum().transpose();
  Eigen::VectorXd rows = over(row_sums, known * columns);
  for (int round = 0; round < kMostRounds; ++round) {
    columns = over(column_sums, known.transpose() * rows);
    const Eigen::VectorXd before = rows;
    rows = over(row_sums, known * columns);
    if ((rows - before).norm() <= kRounding * rows.norm()) break;
  }
  return {rows, columns};
}

}  // namespace

Seen seen(const Structure& structure, const modal::FrfSet& measured, double high_hz) {
  check(structure);
  modal::check(measured);
  Seen result;
  auto rows = places_of(structure.outputs.names, measured.outputs);
  auto cols = places_of(structure.inputs.names, measured.inputs);
  note_strangers(measured.outputs, structure.outputs.names, "sensor", result.notes);
  note_strangers(measured.inputs, structure.inputs.names, "actuator", result.notes);
  std::vector<Index> kept_rows;
  std::vector<Index> kept_cols;
  result.structure = structure;
  result.structure.outputs = measured_part(structure.outputs, rows, kept_rows);
  result.structure.inputs = measured_part(structure.inputs, cols, kept_cols);
  require(!rows.empty() && !cols.empty(),
          "no sensor and actuator of the study is among the measured channels");
  result.structure.residual = structure.residual(kept_rows, kept_cols);
  const auto lines = lines_of(measured, high_hz);
  const auto count = static_cast<Index>(lines.size());
  auto& observed = result.observed;
  observed.outputs = static_cast<Index>(rows.size());
  observed.inputs = static_cast<Index>(cols.size());
  observed.omega.resize(count);
  observed.value.setZero(count, observed.outputs * observed.inputs);
  observed.weight.setZero(count, observed.outputs * observed.inputs);
  fill(observed, measured, lines, rows, cols);
  require((observed.weight.array() > 0.0).any(), "nothing was measured between the channels");
  return result;
}

Observed widened(const Observed& observed, const Eigen::MatrixXd& variance) {
  Observed wide = observed;
  wide.weight =
      (observed.weight.array() > 0.0)
          .select((2.0 / (2.0 / observed.weight.array().square() + variance.array())).sqrt(), 0.0);
  return wide;
}

Eigen::MatrixXd model_variance(const Observed& observed, double response) {
  Eigen::MatrixXd variance(observed.value.rows(), observed.value.cols());
  for (Index k = 0; k < observed.line_count(); ++k) {
    const Eigen::MatrixXd known = (observed.weight.row(k).array() > 0.0)
                                      .cast<double>()
                                      .reshaped(observed.outputs, observed.inputs);
    const Eigen::MatrixXd power =
        observed.value.row(k).cwiseAbs2().reshaped(observed.outputs, observed.inputs);
    const auto [of_outputs, of_inputs] = levels_of(power.cwiseProduct(known), known);
    variance.row(k) =
        (response * response * of_outputs * of_inputs.transpose()).reshaped().transpose();
  }
  return variance;
}

Observed thinned(const Observed& observed, Index count) {
  const Index lines = observed.line_count();
  if (lines <= count) return observed;
  Eigen::VectorXd length = Eigen::VectorXd::Zero(lines);
  for (Index k = 1; k < lines; ++k) {
    double turned = 0.0;
    double responses = 0.0;
    for (Index c = 0; c < observed.value.cols(); ++c) {
      const double a = std::abs(observed.value(k - 1, c));
      const double b = std::abs(observed.value(k, c));
      if (a <= 0.0 || b <= 0.0) continue;
      // Only changes that are not noise count.
      const double noise = 1.0 / (observed.weight(k, c) * b);
      turned += std::max(0.0, std::abs(std::log(b / a)) - kConstants.significant * noise);
      responses += 1.0;
    }
    length(k) = length(k - 1) + (responses > 0.0 ? turned / responses : 0.0);
  }
  // A part of the density follows the length of the curves, the rest is even.
  const double whole = std::max(length(lines - 1), 1e-12);
  const double by_length = kConstants.lines_by_length;
  const double evenly = 1.0 - by_length;
  std::vector<Index> chosen;
  double next = 0.0;
  for (Index k = 0; k < lines; ++k) {
    const double way = by_length * length(k) / whole +
                       evenly * static_cast<double>(k) / static_cast<double>(lines - 1);
    if (way * static_cast<double>(count - 1) < next) continue;
    chosen.push_back(k);
    next = std::floor(way * static_cast<double>(count - 1)) + 1.0;
  }
  Observed part = observed;
  part.omega = observed.omega(chosen);
  part.value = observed.value(chosen, Eigen::all);
  part.weight = observed.weight(chosen, Eigen::all);
  return part;
}

Eigen::VectorXd weighted(const Observed& observed, const Eigen::MatrixXcd& change) {
  const Index n = change.size();
  Eigen::VectorXd rows(2 * n);
  rows.head(n) = (change.real().array() * observed.weight.array()).reshaped();
  rows.tail(n) = (change.imag().array() * observed.weight.array()).reshaped();
  return rows;
}

Eigen::VectorXd residual(const Observed& observed, const Eigen::MatrixXcd& model) {
  return weighted(observed, observed.value - model);
}

}  // namespace chladni::diagnosis
