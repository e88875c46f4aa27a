// All errors of a file, each with its place.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace chladni::study {

/// Errors of one file. They are collected while the file is read, and thrown together.
class Problems {
 public:
  explicit Problems(std::string file) : file_(std::move(file)) {}

  void add(int line, int column, const std::string& message);
  [[nodiscard]] bool empty() const { return found_.empty(); }
  [[nodiscard]] const std::string& file() const { return file_; }

  /// @throws InvalidInput  there are any: the first 20, one line each, "<file>:<line>:<column>:
  /// ..."
  void throw_if_any() const;

 private:
  struct Problem {
    int line, column;
    std::string message;
  };
  std::string file_;
  std::vector<Problem> found_;
};

/// The name of `known` nearest to `word` (Damerau-Levenshtein, at most a third of its letters
/// wrong); empty if none is near.
[[nodiscard]] std::string nearest_name(std::string_view word,
                                       const std::vector<std::string>& known);

/// `"thickness", "width" or "length"`
[[nodiscard]] std::string listed(const std::vector<std::string>& names);

}  // namespace chladni::study
