#include "io/shape_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "base/error.h"
#include "host/atomic_file.h"
#include "io/bytes/csv_table.h"
#include "io/bytes/escape.h"
#include "io/bytes/room.h"
#include "io/csv.h"
#include "io/measured/measurable.h"
#include "io/scan.h"

namespace chladni::io {
namespace {

constexpr std::size_t kMemoryPerByte = 64;  // for short fields, each of which is a string
constexpr std::size_t kMostModes = 100000;
constexpr std::string_view kDeviation = "std_";

struct Line {
  int number = 0;
  std::vector<std::string> fields;
};

[[noreturn]] void fail(const std::string& name, int line, const std::string& what) {
  throw InvalidInput(name + ": line " + fmt::to_string(line) + ": " + what);
}

std::vector<std::string> fields_of(std::string_view line, char separator, const std::string& name,
                                   int number) {
  try {
    return csv_fields(utf8_of(line), separator);
  } catch (const InvalidInput& e) {
    fail(name, number, e.what());
  }
}

std::vector<Line> lines_of(std::string_view bytes, const std::string& name) {
  std::vector<Line> lines;
  char separator = ',';
  int number = 0;
  while (!bytes.empty()) {
    ++number;
    const auto end = bytes.find('\n');
    const auto line = trimmed(bytes.substr(0, end));
    bytes.remove_prefix(end == std::string_view::npos ? bytes.size() : end + 1);
    if (line.empty() || line.front() == '#') continue;
    if (lines.empty()) separator = csv_separator(line);
    lines.push_back({number, fields_of(line, separator, name, number)});
    if (lines.size() > kMostModes + 1) fail(name, number, "more than 100 000 modes");
  }
  return lines;
}

// The columns of the table.
struct TableColumns {
  std::ptrdiff_t frequency = -1, damping = -1, frequency_std = -1, damping_std = -1;
  std::vector<std::string> channels;
  std::vector<std::ptrdiff_t> value, deviation;  // per channel; −1: none
};

void add_deviation(const Line& header, std::ptrdiff_t column, const std::string& name,
                   TableColumns& columns) {
  const auto& field = header.fields[static_cast<std::size_t>(column)];
  const std::string channel = field.substr(kDeviation.size());
  if (channel == "frequency_hz") {
    columns.frequency_std = column;
    return;
  }
  if (channel == "damping_ratio" && columns.damping >= 0) {
    columns.damping_std = column;
    return;
  }
  const auto found = std::find(columns.channels.begin(), columns.channels.end(), channel);
  if (found == columns.channels.end()) {
    fail(name, header.number, "the column " + shown(field) + " has no column " + shown(channel));
  }
  columns.deviation[static_cast<std::size_t>(found - columns.channels.begin())] = column;
}

TableColumns columns_of(const Line& header, const std::string& name, ShapesStated stated) {
  TableColumns columns;
  std::map<std::string, int> seen;
  for (std::size_t c = 0; c < header.fields.size(); ++c) {
    const auto& field = header.fields[c];
    const auto at = static_cast<std::ptrdiff_t>(c);
    if (field.empty())
      fail(name, header.number, "column " + fmt::to_string(c + 1) + " has no name");
    if (++seen[field] > 1) fail(name, header.number, "two columns are called " + shown(field));
    if (field == "frequency_hz") {
      columns.frequency = at;
    } else if (field == "damping_ratio") {
      columns.damping = at;
    } else if (field != "mode" && !field.starts_with(kDeviation)) {
      columns.channels.push_back(field);
      columns.value.push_back(at);
    }
  }
  if (columns.frequency < 0) {
    fail(name, header.number,
         "there is no column frequency_hz; expected a first line such as "
         "\"frequency_hz,s1,s2,std_s1,std_s2\"");
  }
  if (columns.channels.empty() && stated == ShapesStated::all) {
    fail(name, header.number, "there is no column of a channel");
  }
  columns.deviation.assign(columns.channels.size(), -1);
  for (std::size_t c = 0; c < header.fields.size(); ++c) {
    if (!header.fields[c].starts_with(kDeviation)) continue;
    add_deviation(header, static_cast<std::ptrdiff_t>(c), name, columns);
  }
  return columns;
}

double number_at(const Line& line, std::ptrdiff_t column, const Line& header,
                 const std::string& name) {
  const auto at = static_cast<std::size_t>(column);
  const auto value = number_in(line.fields[at]);
  if (!value) fail(name, line.number, header.fields[at] + ": " + not_a_number(line.fields[at]));
  if (!is_measurable(*value)) {
    fail(name, line.number, header.fields[at] + ": " + not_measurable(*value));
  }
  return *value;
}

// Reads the numbers of one line; an empty cell is NaN where the table may have gaps.
class LineReader {
 public:
  LineReader(const Line& line, const Line& header, const std::string& name, ShapesStated stated)
      : line_(line), header_(header), name_(name), stated_(stated) {}

  [[nodiscard]] double number(std::ptrdiff_t column) const {
    const bool may_be_empty = stated_ == ShapesStated::partly;
    if (may_be_empty && line_.fields[static_cast<std::size_t>(column)].empty()) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    return number_at(line_, column, header_, name_);
  }
  // 0: the table has no such column, or an empty cell.
  [[nodiscard]] double deviation(std::ptrdiff_t column) const {
    if (column < 0) return 0.0;
    const double value = number(column);
    if (value <= 0.0) {
      fail(name_, line_.number,
           header_.fields[static_cast<std::size_t>(column)] + " must be more than 0");
    }
    return value > 0.0 ? value : 0.0;
  }

 private:
  const Line& line_;
  const Line& header_;
  const std::string& name_;
  ShapesStated stated_;
};

// What no measurement gives: a mode that grows, a shape that is 0 everywhere.
void require_measured(const Line& line, Eigen::Index mode, const std::string& name,
                      const ShapeTable& table) {
  if (table.damping_ratio(mode) < 0.0) {
    fail(name, line.number,
         fmt::format("damping_ratio is {:.6g}; expected 0 or more, or an empty cell",
                     table.damping_ratio(mode)));
  }
  const auto shape = table.values.col(mode);
  const auto count = shape.array().isFinite().count();
  if (count > 1 && (shape.array() == 0.0).count() == count) {
    fail(name, line.number,
         "all values of the shape are 0; expected its values, and empty cells where it was not "
         "measured");
  }
}

// @param lines  of the table, the first with the names
void refuse_repeats(const std::vector<Line>& lines, const std::string& name,
                    const ShapeTable& table) {
  const auto is_less = [](double a, double b) {  // what was not measured comes last
    return !std::isnan(a) && (std::isnan(b) || a < b);
  };
  const auto is_before = [&](Eigen::Index one, Eigen::Index other) {
    const double a = table.frequency_hz(one), b = table.frequency_hz(other);
    const auto shape = table.values.col(one), other_shape = table.values.col(other);
    return a < b ||
           (a == b && std::lexicographical_compare(shape.begin(), shape.end(), other_shape.begin(),
                                                   other_shape.end(), is_less));
  };
  std::set<Eigen::Index, decltype(is_before)> known(is_before);
  for (Eigen::Index mode = 0; mode < table.values.cols(); ++mode) {
    if (!table.values.col(mode).array().isFinite().any()) continue;
    const auto [found, is_new] = known.insert(mode);
    if (is_new) continue;
    fail(name, lines[static_cast<std::size_t>(mode) + 1].number,
         fmt::format("the mode repeats mode {}, frequency and shape; expected each once",
                     *found + 1));
  }
}

void read_mode(const Line& line, const Line& header, const TableColumns& columns, Eigen::Index mode,
               const std::string& name, ShapesStated stated, ShapeTable& table) {
  if (line.fields.size() != header.fields.size()) {
    fail(name, line.number,
         fmt::to_string(line.fields.size()) + " fields; expected " +
             fmt::to_string(header.fields.size()) + ", as many as the first line has");
  }
  const LineReader reader(line, header, name, stated);
  const double frequency = number_at(line, columns.frequency, header, name);
  if (frequency < 0.0) fail(name, line.number, "frequency_hz is negative");
  if (!is_frequency_of_mode(frequency)) {
    fail(name, line.number, "frequency_hz: " + no_frequency_of_mode(frequency));
  }
  table.frequency_hz(mode) = frequency;
  if (columns.damping >= 0) table.damping_ratio(mode) = reader.number(columns.damping);
  if (std::abs(table.damping_ratio(mode)) >= 1.0) {
    fail(name, line.number,
         fmt::format("damping_ratio is {:.6g}; expected a ratio below 1, such as 0.02 for 2 %",
                     table.damping_ratio(mode)));
  }
  table.frequency_std_hz(mode) = reader.deviation(columns.frequency_std);
  table.damping_std(mode) = reader.deviation(columns.damping_std);
  for (std::size_t s = 0; s < columns.channels.size(); ++s) {
    const auto row = static_cast<Eigen::Index>(s);
    table.values(row, mode) = reader.number(columns.value[s]);
    table.deviation(row, mode) = reader.deviation(columns.deviation[s]);
  }
  if (stated == ShapesStated::partly) require_measured(line, mode, name, table);
}

}  // namespace

ShapeTable parse_shapes(std::string_view bytes, const std::string& name, ShapesStated stated) {
  refuse_utf16(bytes, name);
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  const auto lines = lines_of(bytes, name);
  require(lines.size() >= 2, name + ": " + (lines.empty() ? "no lines" : "no mode") +
                                 "; expected a first line of names and one line per mode");
  const auto& header = lines.front();
  const auto columns = columns_of(header, name, stated);
  const auto s = static_cast<Eigen::Index>(columns.channels.size());
  const auto m = static_cast<Eigen::Index>(lines.size()) - 1;
  const double no_damping =
      stated == ShapesStated::partly ? std::numeric_limits<double>::quiet_NaN() : 0.0;
  ShapeTable table{
      columns.channels,      Eigen::VectorXd(m),          Eigen::VectorXd::Constant(m, no_damping),
      Eigen::MatrixXd(s, m), Eigen::MatrixXd::Zero(s, m), Eigen::VectorXd(m),
      Eigen::VectorXd(m)};
  for (Eigen::Index i = 0; i < m; ++i) {
    read_mode(lines[static_cast<std::size_t>(i) + 1], header, columns, i, name, stated, table);
  }
  if (stated == ShapesStated::partly) refuse_repeats(lines, name, table);
  return table;
}

ShapeTable read_shapes(const std::filesystem::path& file, ShapesStated stated) {
  return parse_shapes(read_whole(file, reading_limit() / kMemoryPerByte), file.string(), stated);
}

void write_shapes(const std::filesystem::path& file, const ShapeTable& table) {
  std::vector<CsvColumn> columns = {{"frequency_hz", table.frequency_hz},
                                    {"damping_ratio", table.damping_ratio}};
  for (std::size_t s = 0; s < table.channels.size(); ++s) {
    const Eigen::VectorXd values = table.values.row(static_cast<Eigen::Index>(s));
    columns.push_back({table.channels[s], values});
  }
  for (std::size_t s = 0; s < table.channels.size(); ++s) {
    const Eigen::VectorXd deviation = table.deviation.row(static_cast<Eigen::Index>(s));
    if (deviation.minCoeff() <= 0.0) continue;
    columns.push_back({std::string(kDeviation) + table.channels[s], deviation});
  }
  write_csv(file, columns);
}

}  // namespace chladni::io
