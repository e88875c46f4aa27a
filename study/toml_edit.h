// Changes to the text of a TOML document that keep everything else, also comments.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "study/toml/toml_text.h"
#include "study/toml/toml_tree.h"

namespace chladni::study {

/// The tables of [[key]], or the one of [key]; empty if there is none.
[[nodiscard]] std::vector<const TomlNode*> tables_of(const TomlNode& root, std::string_view key);

/// Collects changes. Positions are those of the original document. A change may have a comment,
/// which gets a line of its own above it.
class TomlEdit {
 public:
  /// @throws as parse_toml
  TomlEdit(std::string text, const std::string& file);

  [[nodiscard]] const TomlNode& tree() const { return tree_; }
  /// The text of a value in the document, with its quotes.
  [[nodiscard]] std::string_view written(const TomlNode& value) const;

  void replace(const TomlNode& value, const std::string& by, const std::string& comment = {});
  /// Adds key = value to a table, behind an existing value: on a line of its own or, in braces,
  /// after a comma.
  void add_behind(const TomlNode& value, const std::string& key, const std::string& written,
                  const std::string& comment = {});
  /// Replaces `key` of a table, or adds it behind the existing key `anchor`.
  void set(const TomlNode& table, std::string_view anchor, const std::string& key,
           const std::string& written, const std::string& comment = {});
  /// Adds one more table of [[name]], its members with their final text. It goes to the end of the
  /// document, or of the array if that is written in brackets.
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
  std::vector<std::size_t> lines_;  // start of each line
  TomlNode tree_;
  std::vector<Change> changes_;
  std::string tail_;
};

}  // namespace chladni::study
