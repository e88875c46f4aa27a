// Finds variables of a .mat file by their possible names.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "io/mat.h"

namespace chladni::io {

/// The value of the first of these names that exists, in upper or lower case; null where none
/// exists.
[[nodiscard]] const MatValue* mat_value(const MatFields& fields,
                                        std::initializer_list<std::string_view> names);

/// All numbers of the value; empty where the value is null.
/// @throws InvalidInput  the value has no numbers
[[nodiscard]] Eigen::VectorXd mat_numbers(const MatValue* value, std::string_view what);

/// The texts of a cell array, or the rows of a char array without trailing blanks; empty where the
/// value is null. @throws InvalidInput  the value is neither
[[nodiscard]] std::vector<std::string> mat_texts(const MatValue* value, std::string_view what);

/// The size of the value as text: "8000 x 3 x 3".
[[nodiscard]] std::string mat_size(const MatValue& value);

}  // namespace chladni::io
