#include "io/matlab/mat_names.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "io/scan.h"

namespace chladni::io {

const MatValue* mat_value(const MatFields& fields, std::initializer_list<std::string_view> names) {
  const auto value_where = [&](auto is_it) -> const MatValue* {
    const auto found = std::ranges::find_if(fields, [&](const auto& f) { return is_it(f.first); });
    return found == fields.end() ? nullptr : &found->second;
  };
  for (const auto wanted : names) {  // MATLAB tells f and F apart
    if (const auto* found = value_where([&](const auto& name) { return name == wanted; })) {
      return found;
    }
  }
  for (const auto wanted : names) {
    const auto letters = upper(wanted);
    if (const auto* found = value_where([&](const auto& name) { return upper(name) == letters; })) {
      return found;
    }
  }
  return nullptr;
}

bool has_numbers(const MatValue* value) {
  return value != nullptr &&
         (value->kind == MatValue::Kind::number || value->kind == MatValue::Kind::large);
}

void note_unread(const MatFields& fields, const std::set<const MatValue*>& read,
                 const std::set<std::string>& names, std::vector<std::string>& notes) {
  std::vector<std::string> left;
  for (const auto& [name, value] : fields) {
    const auto is_it = [&](std::string_view one) { return upper(one) == upper(name); };
    if (name.empty() || read.contains(&value) || std::ranges::any_of(names, is_it)) continue;
    left.push_back(name);
  }
  if (left.empty()) return;
  notes.push_back((left.size() > 1 ? "the variables " : "the variable ") + listed(left) +
                  (left.size() > 1 ? " are not read" : " is not read"));
}

const MatValue* MatLookup::find(std::initializer_list<std::string_view> names) {
  const auto* value = mat_value(fields_, names);
  if (value != nullptr) count_as_read(value);
  return value;
}

void MatLookup::note_rest(const std::set<std::string>& names,
                          std::vector<std::string>& notes) const {
  note_unread(fields_, read_, names, notes);
}

Eigen::VectorXd mat_numbers(const MatValue* value, std::string_view what) {
  if (value == nullptr) return {};
  require(value->kind != MatValue::Kind::large,
          std::string(what) + " is " + mat_size(*value) + ", more numbers than are read of it");
  require(value->kind == MatValue::Kind::number,
          std::string(what) + " is a " + value->class_name + ", expected numbers");
  require(value->imag.size() == 0, std::string(what) + " is complex, expected real numbers");
  return value->real;
}

std::optional<double> mat_number(const MatValue* value, std::string_view what) {
  const auto numbers = mat_numbers(value, what);
  if (numbers.size() == 0) return std::nullopt;
  require(numbers.size() == 1,
          std::string(what) + " is " + mat_size(*value) + ", expected a number");
  return numbers(0);
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
