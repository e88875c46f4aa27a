// Tables of numbers with a header line of names.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/bytes/gzip.h"
#include "io/bytes/room.h"

namespace chladni::io {

/// r rows of c columns.
struct CsvTable {
  std::string file;                ///< its name, for messages
  std::vector<std::string> names;  ///< c, each once
  int header_line = 0;             ///< line of the file with the names, counted from 1
  std::vector<std::string> units;  ///< c, of the line below the names; none: it holds numbers
  int units_line = 0;              ///< line of the file with the units
  std::vector<int> line;           ///< r: line of the file of each row
  Eigen::MatrixXd values;          ///< r×c; NaN where a field is empty or says nan

  /// The number of the column with this name; −1: there is none.
  [[nodiscard]] Eigen::Index column(std::string_view name) const;
};

/// What separates the fields of a table: a comma; a semicolon or a tab where the first line has no
/// comma.
[[nodiscard]] char csv_separator(std::string_view first_line);

/// The fields of one line, separated by `separator`. A quoted field may contain the separator, and
/// quotes written twice. Blanks around a field are removed.
/// @throws InvalidInput  a quote is not closed, or there are too many fields
[[nodiscard]] std::vector<std::string> csv_fields(std::string_view line, char separator = ',');

/// Reads numbers with a decimal point, separated by commas (or by semicolons or tabs where the
/// first line has no comma). The line below the names may hold units, "Hz,g/N,g/N": no number but a
/// 1, and one unit that is known. Lines end with LF or CR LF. Empty lines and lines that begin with
/// # are skipped. At most 10 000 columns; numbers are limited to kLargestMeasured. Cost: linear;
/// memory 16 bytes per number.
/// @param file  its name, for messages
/// @param limit  of the memory for the numbers [bytes]
/// @throws InvalidInput  names the line and the column, what was found and what was expected; more
///                       numbers than the limit allows
[[nodiscard]] CsvTable csv_table(std::string_view bytes, const std::string& file,
                                 std::size_t limit = reading_limit());

/// The rows of such a table, one after the other, of a file that need not fit the memory. It may be
/// packed by gzip.
class CsvRows {
 public:
  /// @throws InvalidInput  the file cannot be read; the line of the names as csv_table
  explicit CsvRows(const std::filesystem::path& file);

  /// File, names, units and their lines, without rows.
  [[nodiscard]] const CsvTable& head() const { return head_; }
  /// Appends the numbers of the next row, and its line of the file; false at the end.
  /// @throws InvalidInput  as csv_table; a line of more than 16 MB
  bool next(std::vector<double>& numbers, std::vector<int>& lines);

 private:
  std::optional<std::string_view> line();
  void read_units();

  UnpackedFile in_;
  bool is_read_ = false;  ///< nothing is left in the file
  std::string text_;      ///< what was read and not yet used, from at_ on
  std::size_t at_ = 0;
  std::size_t start_ = 0;  ///< of the last line in text_
  int number_ = 0;         ///< of the last line
  char separator_ = ',';
  CsvTable head_;
};

}  // namespace chladni::io
