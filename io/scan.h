// Words and numbers of a file that nobody vouches for, each with the place it stands at.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace chladni::io {

/// `word` as a message may show it: in quotes, at most 40 characters, unprintable ones as '?'.
[[nodiscard]] std::string shown(std::string_view word);

/// The first six names with commas, and how many more there are.
[[nodiscard]] std::string listed(const std::vector<std::string>& names);

/// @throws InvalidInput  the bytes are text in UTF-16, by their mark or by each second one being 0
void refuse_utf16(std::string_view bytes, const std::string& name);

/// Upper case, ASCII letters only: keywords are compared so.
[[nodiscard]] std::string upper(std::string_view word);

/// `text` without blanks, tabs and line ends at both its ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// The finite number that all of `word` is, whatever the locale: a leading '+' and Fortran's D
/// exponent are read, what is too small for a double is 0. None: not such a number.
[[nodiscard]] std::optional<double> number_in(std::string_view word);

/// The same for whole numbers. None: not one, or beyond 64 bits.
[[nodiscard]] std::optional<std::int64_t> integer_in(std::string_view word);

/// Why `word` is no number, for a message: "found '1,5', expected a number with a decimal point".
[[nodiscard]] std::string not_a_number(std::string_view word);

/// Goes through a file once. Lines end with LF, CRLF or CR; `comment` starts one that lasts to the
/// end of its line. The bytes must outlive it. Every failure is InvalidInput, its message starts
/// with the place ("line 12: " or "byte 1200: ").
class Scanner {
 public:
  explicit Scanner(std::string_view bytes, char comment = '\0');

  /// The next word on whatever line; empty at the end of the file.
  [[nodiscard]] std::string_view word();
  /// The next word on this line; empty at its end.
  [[nodiscard]] std::string_view word_on_line();
  /// What is left of this line, trimmed, without its comment.
  [[nodiscard]] std::string_view rest_of_line();
  /// Steps over the end of this line; false where there is no further one.
  bool next_line();

  /// The next word as a number. @param what  is named where it is not ("x of vertex 3")
  [[nodiscard]] double number(std::string_view what);
  [[nodiscard]] std::int64_t integer(std::string_view what);
  /// A whole number that counts things of at least `bytes_each` bytes, which must be there.
  [[nodiscard]] std::int64_t count(std::string_view what, std::size_t bytes_each);
  /// The same check for a count that was read otherwise.
  void require_room(std::int64_t count, std::string_view what, std::size_t bytes_each) const;
  /// The next word must be `expected`, whatever its case.
  void expect(std::string_view expected);

  /// The next `size` bytes. @param what  is named where they are missing
  [[nodiscard]] std::string_view raw(std::size_t size, std::string_view what) {
    if (size > left()) fail_truncated(what);
    const std::string_view bytes = bytes_.substr(at_, size);
    at_ += size;
    return bytes;
  }
  [[nodiscard]] std::string_view remaining() const { return bytes_.substr(at_); }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  /// Places are told as bytes, not lines, from now on.
  void tell_bytes() { tells_bytes_ = true; }
  [[nodiscard]] std::size_t line() const { return line_; }
  /// For failures only: this scanner as it stood at that line.
  [[nodiscard]] Scanner at_line(std::size_t line) const {
    Scanner there = *this;
    there.line_ = line;
    return there;
  }
  [[noreturn]] void fail(const std::string& message) const;
  [[noreturn]] void fail_truncated(std::string_view what) const;

 private:
  void skip_blanks();

  std::string_view bytes_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
  char comment_;
  bool tells_bytes_ = false;
};

enum class Encoding { text, little_endian, big_endian };

/// Numbers of a file that is either text or binary, one after the other.
class Values {
 public:
  Values(Scanner& scanner, Encoding encoding) : scanner_(&scanner), encoding_(encoding) {
    if (encoding != Encoding::text) scanner.tell_bytes();
  }

  /// @throws InvalidInput  the file ends, the word is no number, or it does not fit into T
  template <class T>
  [[nodiscard]] T next(std::string_view what) {
    if (encoding_ == Encoding::text) return from_text<T>(what);
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), scanner_->raw(sizeof(T), what).data(), sizeof(T));
    if ((encoding_ == Encoding::big_endian) != (std::endian::native == std::endian::big)) {
      for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
    }
    return std::bit_cast<T>(bytes);
  }
  [[nodiscard]] bool is_text() const { return encoding_ == Encoding::text; }
  [[nodiscard]] Scanner& scanner() { return *scanner_; }

 private:
  template <class T>
  [[nodiscard]] T from_text(std::string_view what) {
    if constexpr (std::is_floating_point_v<T>) {
      return static_cast<T>(scanner_->number(what));
    } else {
      const std::int64_t value = scanner_->integer(what);
      if (!std::in_range<T>(value)) {
        scanner_->fail(std::string(what) + ": " + std::to_string(value) + " is out of range");
      }
      return static_cast<T>(value);
    }
  }

  Scanner* scanner_;
  Encoding encoding_;
};

}  // namespace chladni::io
