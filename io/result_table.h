// A table of results: each number stands once, with its head, unit and format, and is printed as
// text, as JSON and in the report.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "io/json.h"
#include "io/report.h"

namespace chladni::io {

struct ResultColumn {
  std::string head;                ///< "x"
  std::string unit;                ///< of the cells: "mm"; empty: none
  std::vector<std::string> cells;  ///< one per row
  bool is_shown = true;            ///< false: the column is in JSON alone and has no cells
  int width = 0;                   ///< of the text; 0: as wide as each cell
  int gap = 2;                     ///< spaces before it in the text
  bool is_number = true;           ///< right-aligned
  std::string key;                 ///< in JSON: "x_m"; empty: not there
  std::vector<Json> values;        ///< one per row, in SI, where there is a key
};

/// How the numbers of a column are shown: `scale` times the value, in this format of fmt.
struct NumberFormat {
  std::string format = "{:.6g}";
  double scale = 1.0;
  std::string missing = "-";  ///< for a number that is not finite
};

/// A column of numbers in SI. Without a key they are not in JSON.
[[nodiscard]] ResultColumn number_column(const std::string& head, const std::string& unit,
                                         const Eigen::VectorXd& values, const NumberFormat& format,
                                         int width, const std::string& key = "");
/// A column of words.
[[nodiscard]] ResultColumn word_column(const std::string& head, std::vector<std::string> cells,
                                       int width = 0, const std::string& key = "");
/// A column that is in JSON alone.
[[nodiscard]] ResultColumn json_column(const std::string& key, std::vector<Json> values);
[[nodiscard]] ResultColumn json_column(const std::string& key, const Eigen::VectorXd& values);

struct ResultTable {
  std::string caption;  ///< in the report
  std::vector<ResultColumn> columns;

  [[nodiscard]] std::size_t row_count() const;
};

/// Heads and rows, each with a line end.
[[nodiscard]] std::string text(const ResultTable& table);
/// The rows without the heads.
[[nodiscard]] std::string rows_text(const ResultTable& table);
/// One object per row, of the columns that have a key.
[[nodiscard]] JsonArray json_rows(const ResultTable& table);
/// The columns that are shown, for the report.
[[nodiscard]] Table report_table(const ResultTable& table);

}  // namespace chladni::io
