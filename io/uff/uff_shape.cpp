// Reads dataset 55: mode shapes at nodes.
#include <cmath>
#include <numbers>

#include "io/scan.h"
#include "io/uff/uff_datasets.h"

namespace chladni::io {
namespace {

constexpr std::size_t kMostComponents = 6;

// Reads the real numbers of record 8, up to 6 per line.
std::vector<double> reals(UffLines& lines, long long count, std::vector<std::string>& notes) {
  if (count < 0 || count > 100) {
    lines.fail(std::to_string(count) + " reals of the analysis, expected 0 to 100");
  }
  return uff_text_numbers(lines, static_cast<std::size_t>(count), notes);
}

void read_analysis(UffLines& lines, UffShape& shape, std::vector<std::string>& notes) {
  const std::string line(lines.filled_record("analysis record"));
  const auto words = words_of(line);
  if (words.size() < 2)
    lines.fail("found " + shown(line) + ", expected numbers of integers and reals");
  const auto integers = uff_integer(lines, words[0], "number of integers");
  for (long long read = 6; read < integers && read < 100; read += 8) {
    static_cast<void>(lines.filled_record("integers of the analysis"));
  }
  const auto values = reals(lines, uff_integer(lines, words[1], "number of reals"), notes);
  if (shape.analysis == 2 && values.size() >= 4) {
    shape.frequency_hz = values[0];
    shape.modal_mass = values[1];
    shape.damping_ratio = values[2];
  } else if ((shape.analysis == 3 || shape.analysis == 7) && values.size() >= 2) {
    shape.eigenvalue = {values[0], values[1]};
    const double size = std::abs(shape.eigenvalue);
    shape.frequency_hz = size / (2.0 * std::numbers::pi);
    shape.damping_ratio = size > 0.0 ? -shape.eigenvalue.real() / size : 0.0;
  }
}

void read_nodes(UffLines& lines, UffShape& shape, Eigen::Index components, bool is_complex,
                std::vector<std::string>& notes) {
  const auto each = static_cast<std::size_t>(components) * (is_complex ? 2U : 1U);
  std::vector<double> values;
  while (!lines.at_delimiter()) {
    const auto node = trimmed(lines.take());
    if (node.empty()) continue;
    shape.nodes.push_back(uff_integer(lines, words_of(node).front(), "node of a shape"));
    const auto at_node = uff_text_numbers(lines, each, notes);
    values.insert(values.end(), at_node.begin(), at_node.end());
  }
  shape.values.resize(static_cast<Eigen::Index>(shape.nodes.size()), components);
  std::size_t at = 0;
  for (Eigen::Index n = 0; n < shape.values.rows(); ++n) {
    for (Eigen::Index c = 0; c < components; ++c) {
      const double real = values[at++];
      shape.values(n, c) = {real, is_complex ? values[at++] : 0.0};
    }
  }
}

}  // namespace

std::optional<UffShape> uff_shape(UffLines& lines, std::vector<std::string>& notes) {
  UffShape shape;
  shape.line = lines.line() - 1;
  for (auto& id : shape.id) id = std::string(trimmed(lines.record("identification lines")));
  const std::string line(lines.filled_record("data form"));
  const auto words = words_of(line);
  if (words.size() < 6) lines.fail("found " + shown(line) + ", expected six whole numbers");
  shape.analysis = static_cast<int>(uff_integer(lines, words[1], "analysis type") % 1000);
  shape.type = static_cast<int>(uff_integer(lines, words[3], "type of data") % 1000);
  const auto data_type = uff_integer(lines, words[4], "data type");
  const auto components = uff_integer(lines, words[5], "values per node");
  if ((data_type != 2 && data_type != 5) || (components != 3 && components != 6)) {
    notes.push_back("dataset 55 from line " + std::to_string(shape.line) + " has " +
                    std::to_string(components) + " values per node of type " +
                    std::to_string(data_type) + ": not read");
    while (!lines.at_delimiter()) lines.take();
    return std::nullopt;
  }
  read_analysis(lines, shape, notes);
  read_nodes(lines, shape, components, data_type == 5, notes);
  return shape;
}

}  // namespace chladni::io
