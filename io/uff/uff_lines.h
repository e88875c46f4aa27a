// A universal file line by line, within its datasets.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace chladni::io {

/// Goes through the file once. The bytes must outlive it.
class UffLines {
 public:
  /// @param room  bytes of memory for what is read
  UffLines(std::string_view bytes, std::string file, std::size_t room)
      : bytes_(bytes), file_(std::move(file)), room_(room) {}

  [[nodiscard]] bool at_end() const { return at_ >= bytes_.size(); }
  [[nodiscard]] std::size_t line() const { return line_; }  ///< the number of the next one
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  [[nodiscard]] std::string_view rest() const { return bytes_.substr(at_); }
  [[nodiscard]] std::string_view file() const { return file_; }

  /// The next line without its end, which stays the next one.
  [[nodiscard]] std::string_view peek() const;
  /// The next line; an empty one at the end of the file.
  std::string_view take();
  /// Whether the next line is the -1 around datasets, or there is none.
  [[nodiscard]] bool at_delimiter() const;
  /// The next line of this dataset. @param what  is named where the dataset ends before it
  std::string_view record(std::string_view what);
  /// The same, blank ones passed over.
  std::string_view filled_record(std::string_view what);
  /// Steps over bytes that are no lines.
  void skip(std::size_t bytes) { at_ += bytes; }

  /// Takes so many bytes of the room. @throws InvalidInput  they are not left
  void take_room(double bytes);

  /// What failures say they are in.
  void enter(std::string dataset, std::size_t line) {
    dataset_ = std::move(dataset);
    dataset_line_ = line;
  }
  /// @throws InvalidInput  file, dataset, line and byte before the message
  [[noreturn]] void fail(const std::string& message) const;

 private:
  std::string_view bytes_;
  std::string file_, dataset_;
  std::size_t at_ = 0, line_ = 1, dataset_line_ = 0, room_ = 0;
};

/// The number that begins at or after `at`, which is moved behind it. Numbers end at blanks or
/// where the next one's sign begins ("-1.2E+00-3.4E+00"); exponents may have a D or, of three
/// digits, no letter ("1.0-100"). None: no number; `at` is at the word that is none or at the end.
[[nodiscard]] std::optional<double> run_on_number(std::string_view line, std::size_t& at);

/// The words between blanks.
[[nodiscard]] std::vector<std::string_view> words_of(std::string_view line);

}  // namespace chladni::io
