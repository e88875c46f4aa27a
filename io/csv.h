// Tables for spreadsheets and scripts.
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

namespace chladni::io {

/// A name and one entry per row.
struct CsvColumn {
  std::string name;  ///< with its unit: "frequency_hz"
  std::variant<std::vector<std::string>, Eigen::VectorXd, Eigen::VectorXi> entries;
};

/// CSV after RFC 4180 with line feeds and a first line of names. Numbers have a decimal point in
/// any locale and all significant digits; NaN and infinity are empty.
/// @throws InvalidInput  two columns have a different number of rows or the same name
[[nodiscard]] std::string csv(const std::vector<CsvColumn>& columns);

/// Writes the file whole or not at all. @throws as csv and write_atomically
void write_csv(const std::filesystem::path& file, const std::vector<CsvColumn>& columns);

}  // namespace chladni::io
