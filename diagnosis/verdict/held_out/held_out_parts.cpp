#include "diagnosis/verdict/held_out/held_out_parts.h"

#include <algorithm>
#include <numbers>

#include "base/index.h"
#include "diagnosis/constants.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Kind = HeldOutPart::Kind;

std::vector<Index> all_outputs(const Observed& observed) {
  std::vector<Index> outputs;
  for (Index i = 0; i < observed.outputs; ++i) outputs.push_back(i);
  return outputs;
}

// All lines from `first` to `last`, of these outputs.
DataPart part_of(const Observed& observed, Kind kind, const std::vector<std::string>& names,
                 const std::vector<Index>& outputs, Index first, Index last) {
  DataPart part;
  part.outputs = outputs;
  part.low = observed.omega(first);
  part.high = observed.omega(last);
  part.told.kind = kind;
  part.told.low_hz = part.low / (2.0 * std::numbers::pi);
  part.told.high_hz = part.high / (2.0 * std::numbers::pi);
  for (const auto i : outputs) part.told.sensors.push_back(names[at(i)]);
  return part;
}

// Σ |response|² over the responses of each line, each response over its own mean square. Large at
// every resonance that some response shows.
Eigen::VectorXd levels(const Observed& observed) {
  Eigen::VectorXd level = Eigen::VectorXd::Zero(observed.line_count());
  for (Index c = 0; c < observed.value.cols(); ++c) {
    const Eigen::VectorXd power = observed.value.col(c).cwiseAbs2();
    const double mean = power.mean();
    if (mean > 0.0) level += power / mean;
  }
  return level;
}

// First lines of the blocks, and the number of lines: equal parts, whose borders move by up to a
// third of a part to where the responses are least, between resonances.
std::vector<Index> borders(const Observed& observed) {
  const Index lines = observed.line_count();
  const auto least = static_cast<Index>(kConstants.least_lines);
  const Index count = std::min<Index>(kConstants.line_parts, lines / least);
  std::vector<Index> border{0};
  const Eigen::VectorXd level = levels(observed);
  const Index reach = lines / (3 * std::max<Index>(count, 1));
  for (Index b = 1; b < count; ++b) {
    const Index middle = lines * b / count;
    Index lowest = middle;
    for (Index k = middle - reach; k <= middle + reach; ++k) {
      if (level(k) < level(lowest)) lowest = k;
    }
    if (lowest - border.back() >= least && lines - lowest >= least) border.push_back(lowest);
  }
  border.push_back(lines);
  return border;
}

Observed at_lines(const Observed& observed, const std::vector<Index>& lines) {
  Observed part = observed;
  part.omega = observed.omega(lines);
  part.value = observed.value(lines, Eigen::all);
  part.weight = observed.weight(lines, Eigen::all);
  return part;
}

// Lines with a weight of the responses that are `in` the part, or of the others.
Observed reduced(const Observed& observed, const DataPart& part, bool in) {
  Observed result = observed;
  std::vector<Index> lines;
  for (Index k = 0; k < observed.line_count(); ++k) {
    for (Index c = 0; c < observed.value.cols(); ++c) {
      if (part.holds(c % observed.outputs, observed.omega(k)) != in) result.weight(k, c) = 0.0;
    }
    if ((result.weight.row(k).array() > 0.0).any()) lines.push_back(k);
  }
  return at_lines(result, lines);
}

}  // namespace

bool DataPart::holds(Index output, double omega) const {
  return omega >= low && omega <= high && std::ranges::binary_search(outputs, output);
}

std::vector<DataPart> held_out_parts(const std::vector<std::string>& outputs,
                                     const Observed& observed) {
  std::vector<DataPart> parts;
  const auto least = static_cast<Index>(kConstants.least_lines);
  const Index lines = observed.line_count();
  const Index groups = std::min<Index>(observed.outputs, kConstants.sensor_parts);
  for (Index g = 0; g < groups && groups > 1; ++g) {
    std::vector<Index> rows;
    for (Index i = g; i < observed.outputs; i += groups) rows.push_back(i);
    parts.push_back(part_of(observed, Kind::sensors, outputs, rows, 0, lines - 1));
  }
  const auto rows = all_outputs(observed);
  const auto border = borders(observed);
  for (std::size_t b = 0; b + 1 < border.size() && border.size() > 2; ++b) {
    parts.push_back(part_of(observed, Kind::lines, outputs, rows, border[b], border[b + 1] - 1));
  }
  const double above = observed.omega(lines - 1) -
                       kConstants.upper_part * (observed.omega(lines - 1) - observed.omega(0));
  const Index below = (observed.omega.array() <= above).count();
  if (below >= least && lines - below >= least) {
    parts.push_back(part_of(observed, Kind::upper_band, outputs, rows, below, lines - 1));
  }
  return parts;
}

Observed without(const Observed& observed, const DataPart& part) {
  return reduced(observed, part, false);
}

Observed only(const Observed& observed, const DataPart& part) {
  return reduced(observed, part, true);
}

}  // namespace chladni::diagnosis
