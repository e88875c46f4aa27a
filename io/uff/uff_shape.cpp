// Reads datasets 55 and 2414: mode shapes at nodes.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "io/bytes/escape.h"
#include "io/measured/measurable.h"
#include "io/scan.h"
#include "io/uff/uff_datasets.h"
#include "io/uff/uff_fields.h"

namespace chladni::io {
namespace {

constexpr long long kAtNodes = 1;                 // of 2414
constexpr long long kUnknown = 0;                 // characteristic of the values
constexpr std::array kOfMotion{0, 1, 8, 11, 12};  // types of data, of which 0 and 1 tell nothing

// The data of a shape, from record 6 of dataset 55 and record 9 of dataset 2414.
struct ShapeForm {
  Eigen::Index components = 0;
  bool is_complex = false, is_readable = false;
};

bool is_complex_mode(const UffShape& shape) {
  return shape.analysis == kComplexFirstOrder || shape.analysis == kComplexSecondOrder;
}

ShapeForm read_shape_form(UffLines& lines, UffShape& shape, std::vector<std::string>& notes) {
  const std::string line(lines.filled_record("data form"));
  const auto words = words_of(line);
  if (words.size() < 6) lines.fail("found " + shown(line) + ", expected six whole numbers");
  shape.analysis = static_cast<int>(uff_integer(lines, words[1], "analysis type") % 1000);
  shape.type = static_cast<int>(uff_integer(lines, words[3], "type of data") % 1000);
  const auto data_type = uff_integer(lines, words[4], "data type");
  const auto components = uff_integer(lines, words[5], "values per node");
  const bool is_complex = data_type == kComplexValues || data_type == kDoubleComplex;
  const auto characteristic = uff_integer(lines, words[2], "characteristic of the data");
  const bool is_motion = (components == 3 || components == 6) &&
                         (characteristic == kUnknown || characteristic == kTranslations ||
                          characteristic == kWithRotations);
  const bool has_form =
      is_motion && (is_complex || data_type == kRealValues || data_type == kDoubleValues);
  const bool is_readable = has_form && std::ranges::find(kOfMotion, shape.type) != kOfMotion.end();
  if (has_form && !is_readable) {
    notes.push_back("dataset " + fmt::to_string(shape.dataset) + " from line " +
                    fmt::to_string(shape.line) + " has data of type " + fmt::to_string(shape.type) +
                    ", no displacement (8), velocity (11) or acceleration (12): not read");
  } else if (!is_readable) {
    notes.push_back("dataset " + fmt::to_string(shape.dataset) + " from line " +
                    fmt::to_string(shape.line) + " has " + fmt::to_string(components) +
                    " values per node of type " + fmt::to_string(data_type) + ": not read");
  }
  return {static_cast<Eigen::Index>(components), is_complex, is_readable};
}

// Reads the real numbers of record 8, up to 6 per line.
std::vector<double> reals(UffLines& lines, long long count, std::vector<std::string>& notes) {
  if (count < 0 || count > 100) {
    lines.fail(fmt::to_string(count) + " reals of the analysis, expected 0 to 100");
  }
  return uff_text_numbers(lines, static_cast<std::size_t>(count), notes);
}

void take_eigenvalue(std::complex<double> eigenvalue, UffShape& shape) {
  shape.eigenvalue = eigenvalue;
  const double size = std::abs(eigenvalue);
  shape.frequency_hz = size / (2.0 * std::numbers::pi);
  shape.damping_ratio = size > 0.0 ? -eigenvalue.real() / size : 0.0;
}

// @return  false: it does not state the frequency of a mode, which is noted
bool read_analysis_of_55(UffLines& lines, UffShape& shape, std::vector<std::string>& notes) {
  const std::string line(lines.filled_record("analysis record"));
  const auto words = words_of(line);
  if (words.size() < 2)
    lines.fail("found " + shown(line) + ", expected numbers of integers and reals");
  const auto integers = uff_integer(lines, words[0], "number of integers");
  for (long long read = 6; read < integers && read < 100; read += 8) {
    static_cast<void>(lines.filled_record("integers of the analysis"));
  }
  const auto values = reals(lines, uff_integer(lines, words[1], "number of reals"), notes);
  const std::size_t needed = is_complex_mode(shape) ? 2 : shape.analysis == kNormalMode ? 1 : 0;
  if (values.size() < needed) {
    notes.push_back(
        fmt::format("dataset 55 from line {} does not state the {} of its mode: not read",
                    shape.line, needed == 1 ? "frequency" : "eigenvalue"));
    return false;
  }
  if (is_complex_mode(shape)) {
    take_eigenvalue({values[0], values[1]}, shape);
  } else if (shape.analysis == kNormalMode) {
    shape.frequency_hz = values[0];
    if (values.size() > 1) shape.modal_mass = values[1];
    if (values.size() > 2) shape.damping_ratio = values[2];
  }
  return true;
}

// Records 10 and 11 are eight whole numbers each; 12 and 13 are six reals each.
void read_analysis_of_2414(UffLines& lines, UffShape& shape, std::vector<std::string>& notes) {
  static_cast<void>(lines.filled_record("integers of the analysis"));
  static_cast<void>(lines.filled_record("integers of the analysis"));
  const auto values = uff_text_numbers(lines, 12, notes);
  shape.frequency_hz = values[1];
  shape.modal_mass = values[3];
  shape.damping_ratio = values[4];
  const std::complex<double> eigenvalue(values[6], values[7]);
  if (is_complex_mode(shape) && eigenvalue != 0.0) take_eigenvalue(eigenvalue, shape);
}

void require_frequency(const UffLines& lines, const UffShape& shape) {
  if (is_frequency_of_mode(std::abs(shape.frequency_hz))) return;
  lines.fail("the frequency of a mode: " + no_frequency_of_mode(shape.frequency_hz));
}

void read_nodes(UffLines& lines, UffShape& shape, const ShapeForm& form,
                std::vector<std::string>& notes) {
  const auto each = static_cast<std::size_t>(form.components) * (form.is_complex ? 2U : 1U);
  std::vector<double> values;
  while (!lines.at_delimiter()) {
    const auto node = trimmed(lines.take());
    if (node.empty()) continue;
    shape.nodes.push_back(uff_integer(lines, words_of(node).front(), "node of a shape"));
    const auto at_node = uff_text_numbers(lines, each, notes);
    values.insert(values.end(), at_node.begin(), at_node.end());
  }
  shape.values.resize(static_cast<Eigen::Index>(shape.nodes.size()), form.components);
  std::size_t at = 0;
  for (Eigen::Index n = 0; n < shape.values.rows(); ++n) {
    for (Eigen::Index c = 0; c < form.components; ++c) {
      const double real = values[at++];
      shape.values(n, c) = {real, form.is_complex ? values[at++] : 0.0};
    }
  }
}

void skip_rest(UffLines& lines) {
  while (!lines.at_delimiter()) lines.take();
}

void read_identification(UffLines& lines, UffShape& shape) {
  for (auto& id : shape.id) id = utf8_of(trimmed(lines.record("identification lines")));
}

}  // namespace

std::optional<UffShape> uff_shape_55(UffLines& lines, std::vector<std::string>& notes) {
  UffShape shape;
  shape.line = lines.line() - 1;
  read_identification(lines, shape);
  const ShapeForm form = read_shape_form(lines, shape, notes);
  if (!form.is_readable || !read_analysis_of_55(lines, shape, notes)) {
    skip_rest(lines);
    return std::nullopt;
  }
  require_frequency(lines, shape);
  read_nodes(lines, shape, form, notes);
  return shape;
}

std::optional<UffShape> uff_shape_2414(UffLines& lines, std::vector<std::string>& notes) {
  UffShape shape;
  shape.dataset = 2414;
  shape.line = lines.line() - 1;
  static_cast<void>(lines.record("label of the dataset"));
  static_cast<void>(lines.record("name of the dataset"));
  const auto location = uff_integer(lines, lines.record("location of the data"), "location");
  read_identification(lines, shape);
  const ShapeForm form = read_shape_form(lines, shape, notes);
  if (location != kAtNodes && form.is_readable) {
    notes.push_back("dataset 2414 from line " + fmt::to_string(shape.line) +
                    " has data of location " + fmt::to_string(location) +
                    ", expected 1 (at nodes): not read");
  }
  if (location != kAtNodes || !form.is_readable) {
    skip_rest(lines);
    return std::nullopt;
  }
  read_analysis_of_2414(lines, shape, notes);
  require_frequency(lines, shape);
  read_nodes(lines, shape, form, notes);
  return shape;
}

}  // namespace chladni::io
