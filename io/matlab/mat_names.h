// Variables of a .mat file found by what they may be called.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "io/mat.h"

namespace chladni::io {

/// The value of the first of these names that there is, whatever the case of its letters; null:
/// none.
[[nodiscard]] const MatValue* mat_value(const MatFields& fields,
                                        std::initializer_list<std::string_view> names);

/// Numbers, all of them; empty where the value is null. @throws InvalidInput  it is not of numbers
[[nodiscard]] Eigen::VectorXd mat_numbers(const MatValue* value, std::string_view what);

/// Texts of a cell array, or the rows of a char array without the blanks at their ends; empty where
/// the value is null. @throws InvalidInput  it is neither
[[nodiscard]] std::vector<std::string> mat_texts(const MatValue* value, std::string_view what);

/// "8000 x 3 x 3".
[[nodiscard]] std::string mat_size(const MatValue& value);

}  // namespace chladni::io
