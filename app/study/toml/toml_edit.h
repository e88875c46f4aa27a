// Changes of a TOML document's text that leave all the rest as it is, comments too.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/study/toml/toml_tree.h"

namespace chladni::app {

/// The member of a table; null where it has none of that name, or is no table.
[[nodiscard]] const TomlNode* member(const TomlNode& table, std::string_view key);
/// The tables of [[key]], or the one of [key]; empty where there is none.
[[nodiscard]] std::vector<const TomlNode*> tables_of(const TomlNode& root, std::string_view key);

/// Text in quotes, with what TOML wants escaped.
[[nodiscard]] std::string toml_text(std::string_view text);

/// Collects changes; the places are those of the document it was made of. Each change may have a
/// comment, which goes onto a line of its own above.
class TomlEdit {
 public:
  /// @throws as parse_toml
  TomlEdit(std::string text, const std::string& file);

  [[nodiscard]] const TomlNode& tree() const { return tree_; }
  /// A value as it is written, quotes and all.
  [[nodiscard]] std::string_view written(const TomlNode& value) const;

  void replace(const TomlNode& value, const std::string& by, const std::string& comment = {});
  /// key = value in a table, behind a value that it has: on a line of its own, or, in braces,
  /// behind a comma.
  void add_behind(const TomlNode& value, const std::string& key, const std::string& written,
                  const std::string& comment = {});
  /// Replaces `key` of a table or adds it behind `anchor`, a key it has.
  void set(const TomlNode& table, std::string_view anchor, const std::string& key,
           const std::string& written, const std::string& comment = {});
  /// One more table of [[name]], its members as they are to be written. At the end of the document,
  /// or of the array where that is written in brackets.
  void append(const std::string& name,
              const std::vector<std::pair<std::string, std::string>>& members,
              const std::string& comment);
  void append_comment(const std::string& comment);

  /// The document with all changes. @throws InvalidInput  two of them overlap
  [[nodiscard]] std::string text() const;

 private:
  struct Change {
    std::size_t at = 0, length = 0;
    std::string by;
  };
  [[nodiscard]] std::size_t offset(int line, int column) const;
  [[nodiscard]] std::size_t line_start(std::size_t at) const;
  void comment_above(std::size_t at, const std::string& comment);

  std::string text_, file_;
  std::vector<std::size_t> lines_;  // where each begins
  TomlNode tree_;
  std::vector<Change> changes_;
  std::string tail_;
};

}  // namespace chladni::app
