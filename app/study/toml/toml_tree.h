// A TOML document as a tree with the place of everything in it; the parser itself stays behind its
// door (study_source.cpp).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace chladni::app {

struct TomlMember;

/// One value and where it stands, lines and columns counted from 1.
struct TomlNode {
  enum class Kind { table, array, text, integer, real, truth, date };
  Kind kind = Kind::table;
  int line = 0, column = 0;
  int end_line = 0, end_column = 0;  ///< just behind it
  std::string text;     ///< of a text, as it stands between the quotes; of a number, its digits
  double number = 0.0;  ///< of an integer or a real
  bool truth = false;   ///< of a truth
  std::vector<TomlMember> members;  ///< of a table, in the order of the file
  std::vector<TomlNode> elements;   ///< of an array
  [[nodiscard]] bool is_number() const { return kind == Kind::integer || kind == Kind::real; }
};

struct TomlMember {
  std::string key;
  int line = 0, column = 0;  ///< of the key
  TomlNode value;
};

/// "a table", "an array", "the text "20 mm"", "the number 20", ...
[[nodiscard]] std::string description(const TomlNode& node);

/// The document in `bytes`.
/// @throws InvalidInput  not TOML, not UTF-8 or a key twice: "<file>:<line>:<column>: ..."
[[nodiscard]] TomlNode parse_toml(std::string_view bytes, const std::string& file);

}  // namespace chladni::app
