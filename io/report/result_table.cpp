#include "io/result_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace chladni::io {
namespace {

std::string heading_of(const ResultColumn& column) {
  if (column.unit.empty()) return column.head;
  return fmt::format("{} [{}]", column.head, column.unit);
}

std::string padded(const ResultColumn& column, const std::string& cell) {
  const std::string gap(static_cast<std::size_t>(column.gap), ' ');
  return gap + (column.is_number ? fmt::format("{:>{}}", cell, column.width)
                                 : fmt::format("{:<{}}", cell, column.width));
}

}  // namespace

ResultColumn number_column(const std::string& head, const std::string& unit,
                           const Eigen::VectorXd& values, const NumberFormat& format, int width,
                           const std::string& key) {
  ResultColumn column;
  column.head = head;
  column.unit = unit;
  column.width = width;
  column.key = key;
  for (const double value : values) {
    column.cells.push_back(std::isfinite(value)
                               ? fmt::format(fmt::runtime(format.format), format.scale * value)
                               : format.missing);
    column.values.emplace_back(value);
  }
  return column;
}

ResultColumn word_column(const std::string& head, std::vector<std::string> cells, int width,
                         const std::string& key) {
  ResultColumn column;
  column.head = head;
  column.width = width;
  column.is_number = false;
  column.key = key;
  for (const auto& cell : cells) column.values.emplace_back(cell);
  column.cells = std::move(cells);
  return column;
}

ResultColumn json_column(const std::string& key, std::vector<Json> values) {
  ResultColumn column;
  column.key = key;
  column.values = std::move(values);
  column.is_shown = false;
  return column;
}

ResultColumn json_column(const std::string& key, const Eigen::VectorXd& values) {
  return json_column(key, std::vector<Json>(values.begin(), values.end()));
}

std::size_t ResultTable::row_count() const {
  return columns.empty() ? 0
                         : std::max(columns.front().cells.size(), columns.front().values.size());
}

std::string text(const ResultTable& table) {
  std::string heads;
  for (const auto& column : table.columns) {
    if (column.is_shown) heads += padded(column, heading_of(column));
  }
  heads.erase(heads.find_last_not_of(' ') + 1);
  return heads + "\n" + rows_text(table);
}

std::string rows_text(const ResultTable& table) {
  std::string rows;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    for (const auto& column : table.columns) {
      if (column.is_shown) rows += padded(column, column.cells[row]);
    }
    rows += "\n";
  }
  return rows;
}

JsonArray json_rows(const ResultTable& table) {
  JsonArray rows;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    JsonObject object;
    for (const auto& column : table.columns) {
      if (!column.key.empty()) object.emplace_back(column.key, column.values[row]);
    }
    rows.emplace_back(std::move(object));
  }
  return rows;
}

Table report_table(const ResultTable& table) {
  Table result{table.caption, {}, std::vector<Table::Row>(table.row_count())};
  for (const auto& column : table.columns) {
    if (!column.is_shown) continue;
    result.columns.push_back({heading_of(column), column.is_number});
    for (std::size_t row = 0; row < result.rows.size(); ++row) {
      result.rows[row].cells.push_back(column.cells[row]);
    }
  }
  return result;
}

}  // namespace chladni::io
