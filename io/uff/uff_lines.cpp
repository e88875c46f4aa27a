#include "io/uff/uff_lines.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "io/scan.h"

namespace chladni::io {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_sign(char c) { return c == '+' || c == '-'; }
bool is_blank(char c) { return c == ' ' || c == '\t'; }

// The place after a mantissa at `at`: an optional sign, digits and a point.
std::size_t end_of_mantissa(std::string_view line, std::size_t at) {
  if (at < line.size() && is_sign(line[at])) ++at;
  while (at < line.size() && (is_digit(line[at]) || line[at] == '.')) ++at;
  return at;
}

std::size_t end_of_digits(std::string_view line, std::size_t at) {
  while (at < line.size() && is_digit(line[at])) ++at;
  return at;
}

// The place after an exponent at `at`, if there is one.
std::size_t end_of_exponent(std::string_view line, std::size_t at) {
  if (at == line.size() || std::string_view("eEdD").find(line[at]) == std::string_view::npos) {
    return at;
  }
  ++at;
  if (at < line.size() && is_sign(line[at])) ++at;
  return end_of_digits(line, at);
}

// Whether there is an exponent without a letter at `at`: a sign and three digits that do not begin
// another number. Fortran omits the letter of an exponent with three digits.
bool has_bare_exponent(std::string_view line, std::size_t at) {
  return at < line.size() && is_sign(line[at]) && end_of_digits(line, at + 1) == at + 4 &&
         (at + 4 == line.size() || line[at + 4] != '.');
}

}  // namespace

std::string_view UffLines::peek() const {
  const auto rest = bytes_.substr(std::min(at_, bytes_.size()));
  return rest.substr(0, rest.find_first_of("\r\n"));
}

std::string_view UffLines::take() {
  const auto line = peek();
  at_ = std::min(bytes_.size(), at_ + line.size());
  if (at_ < bytes_.size()) at_ += bytes_.substr(at_, 2) == "\r\n" ? 2 : 1;
  ++line_;
  return line;
}

bool UffLines::at_delimiter() const { return at_end() || trimmed(peek()) == "-1"; }

bool UffLines::at_end_of_dataset() {
  while (!at_end() && trimmed(peek()).empty()) take();
  return at_delimiter();
}

std::string_view UffLines::record(std::string_view what) {
  if (at_end()) fail("the file ends before the " + std::string(what));
  if (at_delimiter()) fail("the dataset ends before the " + std::string(what));
  return take();
}

std::string_view UffLines::filled_record(std::string_view what) {
  static_cast<void>(at_end_of_dataset());
  return record(what);
}

void UffLines::take_room(double bytes) {
  if (bytes > static_cast<double>(room_)) {
    fail("its numbers need " + fmt::to_string(static_cast<long long>(bytes / 1e6) + 1) +
         " MB of memory, and " + fmt::to_string(room_ / 1'000'000) + " MB are left for the file");
  }
  room_ -= static_cast<std::size_t>(bytes);
}

void UffLines::fail(const std::string& message) const {
  throw InvalidInput(file_ + ": dataset " + dataset_ + " (from line " +
                     fmt::to_string(dataset_line_) + "), line " + fmt::to_string(line_) +
                     ", byte " + fmt::to_string(at_) + ": " + message);
}

std::optional<double> run_on_number(std::string_view line, std::size_t& at) {
  while (at < line.size() && is_blank(line[at])) ++at;
  const std::size_t from = at;
  const std::size_t mantissa = end_of_mantissa(line, from);
  if (mantissa == from) return std::nullopt;
  if (has_bare_exponent(line, mantissa)) {
    const auto value = number_in(std::string(line.substr(from, mantissa - from)) + "E" +
                                 std::string(line.substr(mantissa, 4)));
    if (value) at = mantissa + 4;
    return value;
  }
  const std::size_t end = end_of_exponent(line, mantissa);
  if (end < line.size() && !is_blank(line[end]) && !is_sign(line[end])) return std::nullopt;
  const auto value = number_in(line.substr(from, end - from));
  if (value) at = end;
  return value;
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  std::size_t at = 0;
  while (at < line.size()) {
    while (at < line.size() && is_blank(line[at])) ++at;
    const std::size_t from = at;
    while (at < line.size() && !is_blank(line[at])) ++at;
    if (at > from) words.push_back(line.substr(from, at - from));
  }
  return words;
}

}  // namespace chladni::io
