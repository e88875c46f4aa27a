// The functions that read the datasets of a universal file, one function each.
#pragma once

#include "io/uff/uff.h"
#include "io/uff/uff_lines.h"

namespace chladni::io {

/// Reads datasets 58 and 58b. At the start `lines` is after the line `head` with the number. At the
/// end it is before the closing -1.
[[nodiscard]] UffFunction uff_function(UffLines& lines, std::string_view head,
                                       std::vector<std::string>& notes);
/// Reads dataset 55 in the same way; none where its data are not translations or rotations.
[[nodiscard]] std::optional<UffShape> uff_shape(UffLines& lines, std::vector<std::string>& notes);

/// Reads the `count` numbers of a function from text, up to the -1.
[[nodiscard]] std::vector<double> uff_text_numbers(UffLines& lines, std::size_t count,
                                                   std::vector<std::string>& notes);
/// Reads the numbers of a function from bytes. @param head  the line with "58b"
[[nodiscard]] std::vector<double> uff_binary_numbers(UffLines& lines, const std::string& head,
                                                     std::size_t points, int ordinate_type,
                                                     bool even, std::vector<std::string>& notes);

/// A whole number of a record. @throws InvalidInput  names `what`
[[nodiscard]] long long uff_integer(const UffLines& lines, std::string_view word,
                                    std::string_view what);

}  // namespace chladni::io
