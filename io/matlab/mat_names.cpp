#include "io/matlab/mat_names.h"

#include <fmt/format.h>

#include "base/error.h"
#include "io/scan.h"

namespace chladni::io {

const MatValue* mat_value(const MatFields& fields, std::initializer_list<std::string_view> names) {
  for (const auto wanted : names) {
    for (const auto& [name, value] : fields) {
      if (upper(name) == upper(wanted)) return &value;
    }
  }
  return nullptr;
}

Eigen::VectorXd mat_numbers(const MatValue* value, std::string_view what) {
  if (value == nullptr) return {};
  require(value->kind == MatValue::Kind::number,
          std::string(what) + " is a " + value->class_name + ", expected numbers");
  require(value->imag.size() == 0, std::string(what) + " is complex, expected real numbers");
  return value->real;
}

std::vector<std::string> mat_texts(const MatValue* value, std::string_view what) {
  std::vector<std::string> texts;
  if (value == nullptr) return texts;
  const std::string expected =
      std::string(what) + " is a " + value->class_name + ", expected texts: a cell or char array";
  if (value->kind == MatValue::Kind::cell) {
    for (const auto& cell : value->cells) {
      const bool is_empty = cell.size() == 0;
      require(is_empty || (cell.kind == MatValue::Kind::text && cell.text.size() == 1), expected);
      texts.push_back(is_empty ? std::string() : std::string(trimmed(cell.text.front())));
    }
    return texts;
  }
  if (value->kind == MatValue::Kind::number && value->size() == 0) return texts;  // []
  require(value->kind == MatValue::Kind::text, expected);
  for (const auto& row : value->text) texts.emplace_back(trimmed(row));
  return texts;
}

std::string mat_size(const MatValue& value) {
  std::string text;
  for (const auto n : value.dims) text += (text.empty() ? "" : " x ") + fmt::to_string(n);
  return text;
}

}  // namespace chladni::io
