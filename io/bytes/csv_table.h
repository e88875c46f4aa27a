// Columns of numbers under a line of names.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "io/bytes/room.h"

namespace chladni::io {

/// r rows of c columns.
struct CsvTable {
  std::string file;                ///< its name, for messages
  std::vector<std::string> names;  ///< c, each once
  int header_line = 0;             ///< of the file, counted from 1
  std::vector<int> line;           ///< r: where each row stands
  Eigen::MatrixXd values;          ///< r×c; NaN where a field is empty or says nan

  /// The number of the column called so; −1: there is none.
  [[nodiscard]] Eigen::Index column(std::string_view name) const;
};

/// The fields of one line between `separator`; a quoted one may hold it, and quotes written twice.
/// Blanks around a field are left out. @throws InvalidInput  a quote is not closed, too many fields
[[nodiscard]] std::vector<std::string> csv_fields(std::string_view line, char separator = ',');

/// Numbers with a decimal point between commas (or semicolons or tabs, where the first line has no
/// comma); lines ended by LF or CR LF, empty lines and lines that begin with # are passed over. At
/// most 10 000 columns, no number larger than any that is measured. Cost: linear; memory 16 bytes
/// per number.
/// @param file  its name, for messages
/// @param limit  of the memory for the numbers [bytes]
/// @throws InvalidInput  names the line and the column, what was found and what was expected; more
///                       numbers than the limit allows
[[nodiscard]] CsvTable csv_table(std::string_view bytes, const std::string& file,
                                 std::size_t limit = reading_limit());

}  // namespace chladni::io
