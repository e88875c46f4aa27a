// Fields of the text of universal files, in the columns of Fortran's formats.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace chladni::io {

inline constexpr const char* kUffDelimiter = "    -1\n";

// Words of datasets 55 and 2414: the analysis, what the values are, and their type.
inline constexpr int kNormalMode = 2, kComplexFirstOrder = 3, kComplexSecondOrder = 7;
inline constexpr int kTranslations = 2, kWithRotations = 3;
inline constexpr int kRealValues = 2, kDoubleValues = 4, kComplexValues = 5, kDoubleComplex = 6;

/// A number in 13 columns, the first one blank, with all its digits if they fit. Fortran's E13.5
/// reads it.
[[nodiscard]] std::string in_13(double value);
/// A number in 25 columns with 17 digits, by Fortran's 1PD25.16.
[[nodiscard]] std::string in_25(double value);
/// Words in so many columns, which are bytes whatever the letters take; what is longer is cut off.
[[nodiscard]] std::string in_columns(std::string_view words, std::size_t columns);
/// A line of at most 80 bytes with its end; "NONE" for an empty text.
[[nodiscard]] std::string line_80(const std::string& words);
/// Lines of up to six numbers: 6E13.5.
[[nodiscard]] std::string lines_of_6(std::span<const double> values);
/// Lines of up to eight whole numbers: 8I10.
[[nodiscard]] std::string lines_of_8(std::span<const long long> values);

/// Lines of -1 around the content of a dataset with this number.
[[nodiscard]] std::string uff_block(int number, const std::string& content);

}  // namespace chladni::io
