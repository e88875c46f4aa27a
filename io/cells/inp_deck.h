// An Abaqus or CalculiX input deck as its lines say it: keywords with parameters, data lines.
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

  /// The value of a parameter; empty where it is not given or has none.
  [[nodiscard]] std::string value(const std::string& parameter) const;
  [[nodiscard]] bool has(const std::string& parameter) const {
    return parameters.contains(parameter);
  }
};

/// Goes through a deck once. Comments (**) and empty lines are passed over, keyword lines that end
/// with a comma go on on the next.
class InpDeck {
 public:
  explicit InpDeck(std::string_view bytes) : scanner_(bytes) {}

  /// The next keyword, stepping over what data lines are left; false at the end.
  bool next_keyword(Keyword& keyword);
  /// The fields of the next data line of this keyword, trimmed, without empty ones at the end;
  /// false where the next line is a keyword or the deck ends.
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
  bool pending_ = false;  // text_ is read and not yet used
  bool ended_ = false;
};

}  // namespace chladni::io
