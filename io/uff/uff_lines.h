// Reads a universal file line by line, within its datasets.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace chladni::io {

/// Reads the file once from start to end. The bytes must outlive this object.
class UffLines {
 public:
  /// @param room  bytes of memory for the content
  UffLines(std::string_view bytes, std::string file, std::size_t room)
      : bytes_(bytes), file_(std::move(file)), room_(room) {}

  [[nodiscard]] bool at_end() const { return at_ >= bytes_.size(); }
  [[nodiscard]] std::size_t line() const { return line_; }  ///< number of the next line
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  [[nodiscard]] std::string_view rest() const { return bytes_.substr(at_); }
  [[nodiscard]] std::string_view file() const { return file_; }

  /// The next line without its line end; it remains the next line.
  [[nodiscard]] std::string_view peek() const;
  /// Takes the next line; it is empty at the end of the file.
  std::string_view take();
  /// Whether the next line is the -1 around datasets, or the file ends.
  [[nodiscard]] bool at_delimiter() const;
  /// The same behind blank lines, which it takes.
  [[nodiscard]] bool at_end_of_dataset();
  /// Takes the next line of this dataset. @param what  its name in a message where it is missing
  std::string_view record(std::string_view what);
  /// Takes the next line of this dataset that is not blank.
  std::string_view filled_record(std::string_view what);
  /// Skips bytes that are no lines.
  void skip(std::size_t bytes) { at_ += bytes; }

  /// Takes bytes from the room. @throws InvalidInput  there is not enough room left
  void take_room(double bytes);
  [[nodiscard]] std::size_t room() const { return room_; }
  void restore_room(std::size_t bytes) { room_ = bytes; }

  /// Sets the dataset and the line that messages name.
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

/// The number that begins at or after `at`; `at` moves to the place after it. A number ends at a
/// blank or at the sign of the next number ("-1.2E+00-3.4E+00"). An exponent may have a D, or no
/// letter if it has three digits ("1.0-100"). None: there is no number; `at` is then at the word
/// that is no number, or at the end.
[[nodiscard]] std::optional<double> run_on_number(std::string_view line, std::size_t& at);

/// The words between blanks.
[[nodiscard]] std::vector<std::string_view> words_of(std::string_view line);

}  // namespace chladni::io
