// The lines of an Abaqus or CalculiX input deck: keywords with parameters, and data lines.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "io/scan.h"

namespace chladni::io {

struct Keyword {
  std::string name;                               ///< upper case, "SOLID SECTION"
  std::map<std::string, std::string> parameters;  ///< upper case name -> value as written
  std::size_t line = 0;

  /// The value of a parameter; empty where the parameter is missing or has no value.
  [[nodiscard]] std::string value(const std::string& parameter) const;
  [[nodiscard]] bool has(const std::string& parameter) const {
    return parameters.contains(parameter);
  }
};

/// The name of a set in a data line, without its quotes: "my set" or P-1."my set".
[[nodiscard]] std::string label_in(std::string_view field);

/// Reads a deck once from start to end. Comments (**) and empty lines are skipped. A keyword line
/// that ends with a comma continues on the next line.
class InpDeck {
 public:
  explicit InpDeck(std::string_view bytes) : scanner_(bytes) {}

  /// Reads the next keyword and skips the remaining data lines; false at the end.
  bool next_keyword(Keyword& keyword);
  /// Reads the fields of the next data line of this keyword, trimmed, without empty fields at the
  /// end. False where the next line is a keyword or the deck ends.
  bool next_data(std::vector<std::string_view>& fields);

  [[nodiscard]] double number(std::string_view field) const;
  /// The number of a node or an element, or a step between them: 1 to 2^53.
  [[nodiscard]] std::int64_t id(std::string_view field) const;
  [[noreturn]] void fail(const std::string& message) const {
    scanner_.at_line(line_).fail(message);
  }
  [[nodiscard]] std::size_t line() const { return line_; }

 private:
  bool read_line();

  Scanner scanner_;
  std::string_view text_;
  std::size_t line_ = 0;
  bool pending_ = false;  // text_ has been read but not used
  bool ended_ = false;
};

}  // namespace chladni::io
