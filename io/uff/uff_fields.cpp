#include "io/uff/uff_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "io/bytes/escape.h"

namespace chladni::io {
namespace {

template <class Value, class Text>
std::string in_lines(std::span<const Value> values, std::size_t most, Text text) {
  std::string lines;
  for (std::size_t k = 0; k < values.size(); ++k) {
    lines += text(values[k]);
    if ((k + 1) % most == 0 || k + 1 == values.size()) lines += '\n';
  }
  return lines;
}

// A number with a decimal point: where it has none Fortran's E13.5 takes the last five digits for
// decimals.
template <class... Form>
std::string with_point(double value, Form... form) {
  std::array<char, 40> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, form...).ptr;
  std::string digits(buffer.data(), end);
  if (digits.find('.') == std::string::npos) {
    digits.insert(std::min(digits.find('e'), digits.size()), 1, '.');
  }
  return digits;
}

}  // namespace

std::string in_13(double value) {
  auto digits = with_point(value);
  for (int most = 11; digits.size() > 12 && most > 3; --most) {
    digits = with_point(value, std::chars_format::general, most);
  }
  std::ranges::replace(digits, 'e', 'E');
  return fmt::format("{:>13}", digits);
}

std::string in_25(double value) {
  std::string text = fmt::format("{:25.16E}", value);
  std::ranges::replace(text, 'E', 'D');
  return text;
}

std::string in_columns(std::string_view words, std::size_t columns) {
  std::string field(whole_letters(words, columns));
  return field.append(columns - field.size(), ' ');
}

std::string line_80(const std::string& words) {
  std::string line = words.empty() ? "NONE" : std::string(whole_letters(words, 80));
  for (char& c : line) c = static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  return line + "\n";
}

std::string lines_of_6(std::span<const double> values) { return in_lines(values, 6, in_13); }

std::string lines_of_8(std::span<const long long> values) {
  return in_lines(values, 8, [](long long value) { return fmt::format("{:10}", value); });
}

std::string uff_block(int number, const std::string& content) {
  return fmt::format("{}{:6}\n{}{}", kUffDelimiter, number, content, kUffDelimiter);
}

}  // namespace chladni::io
