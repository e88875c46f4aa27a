#include "io/bytes/csv_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>

#include "base/error.h"
#include "io/bytes/escape.h"
#include "io/measured/column_head.h"
#include "io/measured/measurable.h"
#include "io/scan.h"

namespace chladni::io {
namespace {

constexpr std::size_t kMostColumns = 10000;
constexpr std::size_t kBlock = std::size_t{1} << 20U;  // of a file that is read in pieces
constexpr std::size_t kLongestLine = std::size_t{16} << 20U;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

[[noreturn]] void fail(const std::string& file, int line, const std::string& what) {
  throw InvalidInput(file + ": line " + fmt::to_string(line) + ": " + what);
}

// The number in a field, which is the bytes between two separators, with or without quotes.
double number_of(std::string_view field, const CsvTable& table, std::size_t column, int line) {
  field = trimmed(field);
  if (field.size() >= 2 && field.front() == '"' && field.back() == '"') {
    field = trimmed(field.substr(1, field.size() - 2));
  }
  if (field.empty()) return kNan;
  const auto value = number_in(field);
  if (value && is_measurable(*value)) return *value;
  if (value) fail(table.file, line, table.names[column] + ": " + not_measurable(*value));
  if (upper(field.substr(0, 4)) == "NAN") return kNan;
  fail(table.file, line, table.names[column] + ": " + not_a_number(field));
}

void read_row(std::string_view line, char separator, int number, const CsvTable& table,
              std::vector<double>& rows) {
  const std::size_t expected = table.names.size();
  std::size_t column = 0;
  for (bool more = true; more; ++column) {
    const auto end = line.find(separator);
    more = end != std::string_view::npos;
    if (column == expected) {
      const auto extra = static_cast<std::size_t>(std::count(line.begin(), line.end(), separator));
      column += extra + 1;
      break;
    }
    rows.push_back(number_of(line.substr(0, end), table, column, number));
    if (more) line.remove_prefix(end + 1);
  }
  if (column != expected) {
    fail(table.file, number,
         fmt::to_string(column) + " fields; expected " + fmt::to_string(expected) +
             ", as many as the first line has");
  }
}

// Whether a line holds neither names nor numbers.
bool is_idle(std::string_view line) {
  const auto words = trimmed(line);
  return words.empty() || words.front() == '#';
}

void read_header(std::string_view line, char separator, int number, CsvTable& table) {
  table.header_line = number;
  try {
    table.names = csv_fields(utf8_of(line), separator);
  } catch (const InvalidInput& e) {
    fail(table.file, number, e.what());
  }
  std::set<std::string_view> seen;
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    const auto& name = table.names[c];
    if (name.empty()) {
      fail(table.file, number, "column " + fmt::to_string(c + 1) + " has no name");
    }
    if (!seen.insert(name).second) {
      fail(table.file, number, "two columns are called " + shown(name));
    }
    if (number_in(name)) {
      fail(table.file, number,
           "column " + fmt::to_string(c + 1) + " is called " + shown(name) +
               ", a number; expected a first line of names");
    }
  }
}

// Takes a line as that of the units. @return false: it is one of numbers, or nothing at all
bool take_units(std::string_view line, char separator, int number, CsvTable& table) {
  std::vector<std::string> fields;
  try {
    fields = csv_fields(utf8_of(line), separator);
  } catch (const InvalidInput&) {
    return false;
  }
  const auto is_other = [](const std::string& field) {  // "1,5", "nan"
    const auto digit = field.find_first_not_of("+-.");
    const bool is_number = digit != std::string::npos && field[digit] >= '0' && field[digit] <= '9';
    return (is_number && field != "1" && !field.starts_with("1/")) ||
           upper(field).starts_with("NAN");
  };
  if (fields.size() != table.names.size() || std::ranges::any_of(fields, is_other)) return false;
  if (std::ranges::none_of(fields, &is_unit_of_column)) return false;
  table.units = std::move(fields);
  table.units_line = number;
  return true;
}

// The largest possible count of numbers. A field takes at least one byte, its separator or the line
// end.
std::size_t number_count(std::string_view bytes, const CsvTable& table, std::size_t limit) {
  const auto lines = static_cast<std::size_t>(std::count(bytes.begin(), bytes.end(), '\n')) + 1;
  const std::size_t count = std::min(lines * table.names.size(), bytes.size() + 1);
  require_room(16.0 * static_cast<double>(count), limit,
               table.file + ": " + fmt::to_string(table.names.size()) + " columns of " +
                   fmt::to_string(lines) + " lines");
  return count;
}

}  // namespace

Eigen::Index CsvTable::column(std::string_view name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : found - names.begin();
}

char csv_separator(std::string_view header) {
  for (const char c : {',', ';', '\t'}) {
    if (header.find(c) != std::string_view::npos) return c;
  }
  return ',';
}

std::vector<std::string> csv_fields(std::string_view line, char separator) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += line[++i];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == separator && !quoted) {
      fields.emplace_back();
      require(fields.size() <= kMostColumns, "more than 10 000 columns");
    } else {
      fields.back() += c;
    }
  }
  require(!quoted, "a quote is opened and not closed");
  for (auto& field : fields) field = std::string(trimmed(field));
  return fields;
}

CsvTable csv_table(std::string_view bytes, const std::string& file, std::size_t limit) {
  CsvTable table;
  table.file = file;
  std::vector<double> rows;
  char separator = ',';
  refuse_utf16(bytes, file);
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  for (int number = 1; !bytes.empty(); ++number) {
    const auto end = bytes.find('\n');
    auto line = bytes.substr(0, end);
    bytes.remove_prefix(end == std::string_view::npos ? bytes.size() : end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (is_idle(line)) continue;
    if (table.names.empty()) {
      separator = csv_separator(line);
      read_header(line, separator, number, table);
      rows.reserve(number_count(bytes, table, limit));
    } else if (!table.line.empty() || table.units_line > 0 ||
               !take_units(line, separator, number, table)) {
      read_row(line, separator, number, table, rows);
      table.line.push_back(number);
    }
  }
  require(!table.names.empty(), file + ": no lines; expected a first line of names");
  const auto c = static_cast<Eigen::Index>(table.names.size());
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  table.values =
      Eigen::Map<const Rows>(rows.data(), static_cast<Eigen::Index>(table.line.size()), c);
  return table;
}

CsvRows::CsvRows(const std::filesystem::path& file) : in_(file) {
  head_.file = file.string();
  while (const auto next = line()) {
    if (is_idle(*next)) continue;
    separator_ = csv_separator(*next);
    read_header(*next, separator_, number_, head_);
    read_units();
    return;
  }
  throw InvalidInput(head_.file + ": no lines; expected a first line of names");
}

void CsvRows::read_units() {
  while (const auto next = line()) {
    if (is_idle(*next)) continue;
    if (take_units(*next, separator_, number_, head_)) return;
    at_ = start_;  // the line is read again
    --number_;
    return;
  }
}

bool CsvRows::next(std::vector<double>& numbers, std::vector<int>& lines) {
  while (const auto next = line()) {
    if (is_idle(*next)) continue;
    read_row(*next, separator_, number_, head_, numbers);
    lines.push_back(number_);
    return true;
  }
  return false;
}

// The next line without its end; it holds until the next call.
std::optional<std::string_view> CsvRows::line() {
  auto end = text_.find('\n', at_);
  while (end == std::string::npos && !is_read_) {
    text_.erase(0, at_);
    at_ = 0;
    const auto before = text_.size();
    if (before > kLongestLine) {
      fail(head_.file, number_ + 1, "more than 16 MB; expected a line of numbers");
    }
    text_.resize(before + kBlock);
    const auto count = in_.read(text_.data() + before, kBlock);
    is_read_ = count < kBlock;
    text_.resize(before + count);
    if (number_ == 0 && before == 0) {
      refuse_utf16(text_, head_.file);
      if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;
    }
    end = text_.find('\n', std::max(before, at_));
  }
  if (at_ >= text_.size()) return std::nullopt;
  const auto stop = std::min(end, text_.size());
  auto line = std::string_view(text_).substr(at_, stop - at_);
  start_ = at_;
  at_ = std::min(stop + 1, text_.size());
  ++number_;
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

}  // namespace chladni::io
