// Reads words and numbers of a file that may be wrong, and knows the place of each.
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

/// `word` for a message: in quotes, at most 40 characters, unprintable characters as '?'.
[[nodiscard]] std::string shown(std::string_view word);

/// The first six names, separated by commas, and the number of further names.
[[nodiscard]] std::string listed(const std::vector<std::string>& names);

/// @throws InvalidInput  the bytes are UTF-16 text (by the byte order mark, or every second byte is
///                       0)
void refuse_utf16(std::string_view bytes, const std::string& name);

/// `word` in upper case (ASCII letters only), for the comparison of keywords.
[[nodiscard]] std::string upper(std::string_view word);

/// `text` without blanks, tabs and line ends at its start and end.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// The finite number that the whole `word` represents, in any locale. A leading '+' and Fortran's D
/// exponent are accepted; a number too small for a double is 0. None: not such a number.
[[nodiscard]] std::optional<double> number_in(std::string_view word);

/// The whole number that `word` represents. None: not a whole number, or beyond 64 bits.
[[nodiscard]] std::optional<std::int64_t> integer_in(std::string_view word);

/// A message that `word` is no number: "found '1,5', expected a number with a decimal point".
[[nodiscard]] std::string not_a_number(std::string_view word);

/// Reads a file once from start to end. Lines end with LF, CRLF or CR. `comment` starts a comment
/// up to the end of the line. The bytes must outlive the scanner. Every failure is InvalidInput
/// with a message that starts with the place ("line 12: " or "byte 1200: ").
class Scanner {
 public:
  explicit Scanner(std::string_view bytes, char comment = '\0');

  /// The next word on this or a later line; empty at the end of the file.
  [[nodiscard]] std::string_view word();
  /// The next word on this line; empty at the end of the line.
  [[nodiscard]] std::string_view word_on_line();
  /// The rest of this line, trimmed, without its comment.
  [[nodiscard]] std::string_view rest_of_line();
  /// Steps over the end of this line; false where there is no further line.
  bool next_line();

  /// The next word as a number. @param what  its name in messages ("x of vertex 3")
  [[nodiscard]] double number(std::string_view what);
  [[nodiscard]] std::int64_t integer(std::string_view what);
  /// A whole number that counts items of at least `bytes_each` bytes. The rest of the file must
  /// have room for so many items.
  [[nodiscard]] std::int64_t count(std::string_view what, std::size_t bytes_each);
  /// The same check for a count from elsewhere.
  void require_room(std::int64_t count, std::string_view what, std::size_t bytes_each) const;
  /// The next word must be `expected`, in upper or lower case.
  void expect(std::string_view expected);

  /// The next `size` bytes. @param what  their name in a message where they are missing
  [[nodiscard]] std::string_view raw(std::size_t size, std::string_view what) {
    if (size > left()) fail_truncated(what);
    const std::string_view bytes = bytes_.substr(at_, size);
    at_ += size;
    return bytes;
  }
  [[nodiscard]] std::string_view remaining() const { return bytes_.substr(at_); }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  /// From now on messages give places as bytes, not lines.
  void tell_bytes() { tells_bytes_ = true; }
  [[nodiscard]] std::size_t line() const { return line_; }
  /// A scanner at that line, for failures only.
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

/// Reads numbers of a text or binary file, one after the other.
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
