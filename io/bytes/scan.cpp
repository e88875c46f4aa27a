#include "io/scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/error.h"

namespace chladni::io {
namespace {

constexpr std::string_view kBlanks = " \t\v\f\r\n";

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
bool ends_line(char c) { return c == '\n' || c == '\r'; }

char upper_letter(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

std::string_view without_plus(std::string_view word) {
  const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+';
  return plus ? word.substr(1) : word;
}

std::optional<double> plain_number(std::string_view word) {
  double value = 0.0;
  const char* const end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (stop != end || word.empty()) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    const bool tiny = word.find("e-") != word.npos || word.find("E-") != word.npos;
    return tiny ? std::optional<double>(0.0) : std::nullopt;
  }
  if (error != std::errc{} || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

std::string shown(std::string_view word) {
  constexpr std::size_t kLongest = 40;
  std::string text = "'";
  for (const char c : word.substr(0, kLongest)) text += c >= ' ' && c <= '~' ? c : '?';
  return text + (word.size() > kLongest ? "...'" : "'");
}

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t most = 6;
  std::string list;
  for (std::size_t n = 0; n < std::min(names.size(), most); ++n) {
    if (n > 0) list += ", ";
    list += names[n];
  }
  if (names.size() > most) list += " and " + fmt::to_string(names.size() - most) + " more";
  return list;
}

void refuse_utf16(std::string_view bytes, const std::string& name) {
  const auto zeros = [&](std::size_t from) {  // every second byte of the first ones, the rest not
    for (std::size_t at = 0; at < std::min<std::size_t>(bytes.size(), 16); ++at) {
      if ((bytes[at] == '\0') != (at % 2 == from)) return false;
    }
    return bytes.size() >= 4;
  };
  const bool marked = bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF");
  require(!marked && !zeros(0) && !zeros(1),
          name + ": this file is text in UTF-16; save it as UTF-8 (\"CSV UTF-8\", \"encoding\")");
}

std::string upper(std::string_view word) {
  std::string result(word);
  std::transform(result.begin(), result.end(), result.begin(), upper_letter);
  return result;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::optional<double> number_in(std::string_view word) {
  const std::string_view number = without_plus(word);
  if (const auto value = plain_number(number)) return value;
  const std::size_t exponent = number.find_first_of("dD");
  if (exponent == number.npos || number.size() > 64) return std::nullopt;
  std::string with_e(number);
  with_e[exponent] = 'e';
  return plain_number(with_e);
}

std::optional<std::int64_t> integer_in(std::string_view word) {
  const std::string_view number = without_plus(word);
  std::int64_t value = 0;
  const char* const end = number.data() + number.size();
  const auto [stop, error] = std::from_chars(number.data(), end, value);
  if (stop != end || error != std::errc{} || number.empty()) return std::nullopt;
  return value;
}

std::string not_a_number(std::string_view word) {
  const std::string found = "found " + shown(word) + ", expected a ";
  const std::size_t comma = word.find(',');
  if (comma != word.npos && word.size() <= 64) {
    std::string with_point(word);
    with_point[comma] = '.';
    if (number_in(with_point)) {
      return found + "number with a decimal point (written under a locale with decimal commas?)";
    }
  }
  double value = 0.0;
  const std::string_view number = without_plus(word);
  const auto end = number.data() + number.size();
  const auto [stop, error] = std::from_chars(number.data(), end, value);
  return found + (stop == end && !number.empty() ? "finite number" : "number");
}

Scanner::Scanner(std::string_view bytes, char comment) : bytes_(bytes), comment_(comment) {
  if (bytes_.starts_with("\xEF\xBB\xBF")) at_ = 3;  // the byte order mark of UTF-8
}

void Scanner::skip_blanks() {
  while (at_ < bytes_.size() && is_blank(bytes_[at_])) ++at_;
  if (at_ < bytes_.size() && comment_ != '\0' && bytes_[at_] == comment_) {
    while (at_ < bytes_.size() && !ends_line(bytes_[at_])) ++at_;
  }
}

bool Scanner::next_line() {
  while (at_ < bytes_.size() && !ends_line(bytes_[at_])) ++at_;
  if (at_ == bytes_.size()) return false;
  const bool crlf = bytes_.substr(at_, 2) == "\r\n";
  at_ += crlf ? 2 : 1;
  ++line_;
  return true;
}

std::string_view Scanner::word_on_line() {
  skip_blanks();
  const std::size_t first = at_;
  while (at_ < bytes_.size() && !is_blank(bytes_[at_]) && !ends_line(bytes_[at_])) ++at_;
  return bytes_.substr(first, at_ - first);
}

std::string_view Scanner::word() {
  std::string_view found = word_on_line();
  while (found.empty() && next_line()) found = word_on_line();
  return found;
}

std::string_view Scanner::rest_of_line() {
  const std::size_t first = at_;
  while (at_ < bytes_.size() && !ends_line(bytes_[at_])) ++at_;
  std::string_view rest = bytes_.substr(first, at_ - first);
  if (comment_ != '\0') rest = rest.substr(0, rest.find(comment_));
  return trimmed(rest);
}

double Scanner::number(std::string_view what) {
  const std::string_view found = word();
  if (found.empty()) fail_truncated(what);
  const auto value = number_in(found);
  if (!value) fail(std::string(what) + ": " + not_a_number(found));
  return *value;
}

std::int64_t Scanner::integer(std::string_view what) {
  const std::string_view found = word();
  if (found.empty()) fail_truncated(what);
  const auto value = integer_in(found);
  if (!value) fail(std::string(what) + ": found " + shown(found) + ", expected a whole number");
  return *value;
}

std::int64_t Scanner::count(std::string_view what, std::size_t bytes_each) {
  const std::int64_t value = integer("number of " + std::string(what));
  require_room(value, what, bytes_each);
  return value;
}

void Scanner::require_room(std::int64_t count, std::string_view what,
                           std::size_t bytes_each) const {
  if (count < 0) fail("a negative number of " + std::string(what) + ": " + fmt::to_string(count));
  const std::size_t room = (left() + 1) / bytes_each;  // the last one may lack its line end
  if (static_cast<std::uint64_t>(count) > room) {
    fail("the file claims " + fmt::to_string(count) + " " + std::string(what) + ", but the " +
         fmt::to_string(left()) + " bytes that follow have room for " + fmt::to_string(room) +
         " at most: truncated or not what it says");
  }
}

void Scanner::expect(std::string_view expected) {
  const std::string_view found = word();
  if (found.empty()) fail_truncated("'" + std::string(expected) + "'");
  if (upper(found) != upper(expected)) {
    fail("found " + shown(found) + ", expected '" + std::string(expected) + "'");
  }
}

void Scanner::fail(const std::string& message) const {
  throw InvalidInput(
      (tells_bytes_ ? "byte " + fmt::to_string(at_) : "line " + fmt::to_string(line_)) + ": " +
      message);
}

void Scanner::fail_truncated(std::string_view what) const {
  fail("the file ends where it should give " + std::string(what) + ": truncated");
}

}  // namespace chladni::io
