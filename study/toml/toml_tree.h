// A TOML document as a tree, with the position of each part. Only study_source.cpp uses the parser.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace chladni::study {

struct TomlMember;

/// One value and its position; lines and columns are counted from 1.
struct TomlNode {
  enum class Kind { table, array, text, integer, real, truth, date };
  Kind kind = Kind::table;
  int line = 0, column = 0;
  int end_line = 0, end_column = 0;  ///< just after its end
  std::string text;     ///< for a text, the text between the quotes; for a number, its digits
  double number = 0.0;  ///< for an integer or a real
  bool truth = false;   ///< for a truth
  std::vector<TomlMember> members;  ///< for a table, in the order of the file
  std::vector<TomlNode> elements;   ///< for an array
  [[nodiscard]] bool is_number() const { return kind == Kind::integer || kind == Kind::real; }
};

struct TomlMember {
  std::string key;
  int line = 0, column = 0;  ///< of the key
  TomlNode value;
};

/// A node without content, at the place of another one.
[[nodiscard]] inline TomlNode node_at(const TomlNode& place, TomlNode::Kind kind) {
  TomlNode node;
  node.kind = kind;
  node.line = place.line;
  node.column = place.column;
  node.end_line = place.end_line;
  node.end_column = place.end_column;
  return node;
}

/// The member of a table; null if it has none of that name, or is not a table.
template <typename Node>
[[nodiscard]] Node* member(Node& table, std::string_view key) {
  for (auto& one : table.members) {
    if (one.key == key) return &one.value;
  }
  return nullptr;
}

/// "a table", "an array", "the text "20 mm"", "the number 20", ...
[[nodiscard]] std::string description(const TomlNode& node);

/// The document in `bytes`.
/// @throws InvalidInput  not TOML, not UTF-8 or a key twice: "<file>:<line>:<column>: ..."
[[nodiscard]] TomlNode parse_toml(std::string_view bytes, const std::string& file);

}  // namespace chladni::study
