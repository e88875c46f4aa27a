#include "io/csv.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <string_view>

#include "base/error.h"
#include "host/atomic_file.h"

namespace chladni::io {
namespace {

Eigen::Index row_count(const CsvColumn& column) {
  return std::visit([](const auto& entries) { return static_cast<Eigen::Index>(entries.size()); },
                    column.entries);
}

std::string cell(const std::string& word) {
  if (word.find_first_of(",\"\r\n") == std::string::npos) return word;
  std::string quoted = "\"";
  for (const char c : word) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string cell(double value) {
  if (!std::isfinite(value)) return {};
  std::array<char, 32> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

std::string cell(int value) { return fmt::to_string(value); }

std::string cell(const CsvColumn& column, Eigen::Index row) {
  if (const auto* words = std::get_if<std::vector<std::string>>(&column.entries)) {
    return cell((*words)[static_cast<std::size_t>(row)]);
  }
  if (const auto* whole = std::get_if<Eigen::VectorXi>(&column.entries)) return cell((*whole)(row));
  return cell(std::get<Eigen::VectorXd>(column.entries)(row));
}

}  // namespace

std::string csv(const std::vector<CsvColumn>& columns) {
  std::set<std::string_view> names;
  std::string text;
  const Eigen::Index rows = columns.empty() ? 0 : row_count(columns.front());
  for (const CsvColumn& column : columns) {
    require(row_count(column) == rows, "CSV: column \"" + column.name + "\" has " +
                                           fmt::to_string(row_count(column)) + " rows, expected " +
                                           fmt::to_string(rows));
    require(names.insert(column.name).second, "CSV: there are two columns \"" + column.name + "\"");
    text += (text.empty() ? "" : ",") + cell(column.name);
  }
  text += '\n';
  for (Eigen::Index row = 0; row < rows; ++row) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (c > 0) text += ',';
      text += cell(columns[c], row);
    }
    text += '\n';
  }
  return text;
}

void write_csv(const std::filesystem::path& file, const std::vector<CsvColumn>& columns) {
  write_atomically(file, csv(columns));
}

}  // namespace chladni::io
