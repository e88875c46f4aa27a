// Measured modes as a table: one line per mode, one column per channel.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace chladni::io {

/// m modes at s channels.
struct ShapeTable {
  std::vector<std::string> channels;   ///< s
  Eigen::VectorXd frequency_hz;        ///< m
  Eigen::VectorXd damping_ratio;       ///< m; 0 where the table has none
  Eigen::MatrixXd values;              ///< s×m, one unit for each mode
  Eigen::MatrixXd deviation;           ///< s×m: standard deviations; 0 where the table has none
  Eigen::VectorXd frequency_std_hz{};  ///< m; 0 where the table has none
  Eigen::VectorXd damping_std{};       ///< m, of the ratio; 0 where the table has none
};

/// What a table must state.
enum class ShapesStated {
  all,     ///< a channel or more, and a number in each cell
  partly,  ///< frequencies; an empty cell is NaN: not measured. No damping column: all NaN
};

/// Reads CSV with a first line of names: `frequency_hz`, optionally `damping_ratio` and `mode` (not
/// read), then for each channel its name and optionally `std_` and its name. `std_frequency_hz` and
/// `std_damping_ratio` are the deviations of those columns. Numbers have a decimal point; fields
/// may be in quotes; lines end with LF or CR LF. Empty lines and lines that begin with # are
/// skipped. At most 100 000 modes and 10 000 columns.
/// @param name  of the file, for messages
/// @throws InvalidInput  names the line, what was found and what was expected
[[nodiscard]] ShapeTable parse_shapes(std::string_view bytes, const std::string& name,
                                      ShapesStated stated = ShapesStated::all);

/// Reads a file. @throws InvalidInput  as parse_shapes, or the file cannot be read
[[nodiscard]] ShapeTable read_shapes(const std::filesystem::path& file,
                                     ShapesStated stated = ShapesStated::all);

/// Writes a file that read_shapes reads back to the last bit. @throws as write_atomically
void write_shapes(const std::filesystem::path& file, const ShapeTable& table);

}  // namespace chladni::io
