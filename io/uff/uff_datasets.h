// The functions that read the datasets of a universal file, one function each.
#pragma once

#include "io/uff/uff.h"
#include "io/uff/uff_lines.h"

namespace chladni::io {

/// Reads datasets 58 and 58b. At the start `lines` is after the line `head` with the number. At the
/// end it is before the closing -1.
[[nodiscard]] UffFunction uff_function(UffLines& lines, std::string_view head,
                                       std::vector<std::string>& notes);
/// Read datasets 55 and 2414 in the same way; none where their data are not translations or
/// rotations of nodes.
[[nodiscard]] std::optional<UffShape> uff_shape_55(UffLines& lines,
                                                   std::vector<std::string>& notes);
[[nodiscard]] std::optional<UffShape> uff_shape_2414(UffLines& lines,
                                                     std::vector<std::string>& notes);

/// Reads dataset 82: the nodes of a trace line.
[[nodiscard]] std::vector<long long> uff_trace_line(UffLines& lines);
/// Reads dataset 2412: the nodes of each element.
void read_elements_of_2412(UffLines& lines, std::vector<std::vector<long long>>& elements);

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
