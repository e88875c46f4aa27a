// The datasets of a universal file that are read, one function each.
#pragma once

#include "io/uff/uff.h"
#include "io/uff/uff_lines.h"

namespace chladni::io {

/// Datasets 58 and 58b. `lines` is behind the line with the number, which is `head`; afterwards it
/// is before the closing -1.
[[nodiscard]] UffFunction uff_function(UffLines& lines, std::string_view head,
                                       std::vector<std::string>& notes);
/// Dataset 55, likewise; none where its data are not translations or rotations.
[[nodiscard]] std::optional<UffShape> uff_shape(UffLines& lines, std::vector<std::string>& notes);

/// The numbers of a function from text: `count` of them up to the -1.
[[nodiscard]] std::vector<double> uff_text_numbers(UffLines& lines, std::size_t count,
                                                   std::vector<std::string>& notes);
/// The same from bytes. @param head  the line with "58b"
[[nodiscard]] std::vector<double> uff_binary_numbers(UffLines& lines, const std::string& head,
                                                     std::size_t points, int ordinate_type,
                                                     bool even, std::vector<std::string>& notes);

/// A whole number of a record. @throws InvalidInput  names `what`
[[nodiscard]] long long uff_integer(const UffLines& lines, std::string_view word,
                                    std::string_view what);

}  // namespace chladni::io
