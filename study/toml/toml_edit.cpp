#include "study/toml_edit.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"

namespace chladni::study {
namespace {

bool continues_character(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20U || c == 0x7F; }

std::string commented(const std::string& comment) {
  std::string result;
  std::size_t begin = 0;
  while (begin <= comment.size()) {
    const auto end = std::min(comment.find('\n', begin), comment.size());
    std::string line = comment.substr(begin, end - begin);
    std::replace_if(line.begin(), line.end(), is_control, ' ');
    result += "# " + line + "\n";
    begin = end + 1;
  }
  return result;
}

}  // namespace

std::vector<const TomlNode*> tables_of(const TomlNode& root, std::string_view key) {
  const auto* node = member(root, key);
  if (node == nullptr) return {};
  if (node->kind == TomlNode::Kind::table) return {node};
  std::vector<const TomlNode*> tables;
  for (const auto& one : node->elements) tables.push_back(&one);
  return tables;
}

TomlEdit::TomlEdit(std::string text, const std::string& file)
    : text_(std::move(text)), file_(file), lines_{0}, tree_(parse_toml(text_, file)) {
  for (std::size_t at = 0; at < text_.size(); ++at) {
    if (text_[at] == '\n') lines_.push_back(at + 1);
  }
}

std::size_t TomlEdit::offset(int line, int column) const {
  auto at = lines_.at(static_cast<std::size_t>(line - 1));
  // Columns count characters, not bytes.
  for (int passed = 1; passed < column && at < text_.size(); ++passed) {
    ++at;
    while (at < text_.size() && continues_character(text_[at])) ++at;
  }
  return at;
}

std::size_t TomlEdit::line_start(std::size_t at) const {
  return *std::prev(std::upper_bound(lines_.begin(), lines_.end(), at));
}

std::string_view TomlEdit::written(const TomlNode& value) const {
  const auto begin = offset(value.line, value.column);
  return std::string_view(text_).substr(begin, offset(value.end_line, value.end_column) - begin);
}

void TomlEdit::comment_above(std::size_t at, const std::string& comment) {
  if (comment.empty()) return;
  const auto start = line_start(at);
  const auto shown = std::min(text_.find_first_not_of(" \t", start), text_.size());
  const std::string indent = text_.substr(start, shown - start);
  changes_.push_back({start, 0, indent + commented(comment)});
}

void TomlEdit::replace(const TomlNode& value, const std::string& by, const std::string& comment) {
  const auto begin = offset(value.line, value.column);
  comment_above(begin, comment);
  changes_.push_back({begin, offset(value.end_line, value.end_column) - begin, by});
}

void TomlEdit::add_behind(const TomlNode& value, const std::string& key, const std::string& written,
                          const std::string& comment) {
  const auto end = offset(value.end_line, value.end_column);
  const auto rest = std::min(text_.find_first_not_of(" \t\r", end), text_.size());
  if (rest < text_.size() && text_[rest] != '\n' && text_[rest] != '#') {
    comment_above(offset(value.line, value.column), comment);
    changes_.push_back({end, 0, ", " + key + " = " + written});
    return;
  }
  // "material.density = ..." has its table before the last dot.
  const auto start = line_start(offset(value.line, value.column));
  const auto equals = text_.find('=', start);
  const auto dot = text_.rfind('.', std::min(equals, end));
  const bool dotted = dot != std::string::npos && dot >= start && dot < equals;
  const std::string name = (dotted ? text_.substr(start, dot + 1 - start) : "") + key;
  const auto line_end = text_.find('\n', end);
  const std::string line = (comment.empty() ? "" : commented(comment)) + name + " = " + written;
  if (line_end == std::string::npos) {
    changes_.push_back({text_.size(), 0, "\n" + line});
  } else {
    changes_.push_back({line_end + 1, 0, line + "\n"});
  }
}

void TomlEdit::set(const TomlNode& table, std::string_view anchor, const std::string& key,
                   const std::string& written, const std::string& comment) {
  if (const auto* there = member(table, key)) return replace(*there, written, comment);
  const auto* behind = member(table, anchor);
  require(behind != nullptr, file_ + ":" + fmt::to_string(table.line) + ": a table has no \"" +
                                 std::string(anchor) + "\" behind which to write \"" + key + "\"");
  add_behind(*behind, key, written, comment);
}

void TomlEdit::append(const std::string& name,
                      const std::vector<std::pair<std::string, std::string>>& members,
                      const std::string& comment) {
  const auto* there = member(tree_, name);
  const bool in_brackets = there != nullptr && !written(*there).starts_with("[[") &&
                           there->kind == TomlNode::Kind::array;
  if (!in_brackets) {
    tail_ += "\n" + commented(comment) + "[[" + name + "]]\n";
    for (const auto& [key, value] : members) tail_ += key + " = " + value + "\n";
    return;
  }
  std::string line;
  for (const auto& [key, value] : members) line += (line.empty() ? "" : ", ") + key + " = " + value;
  comment_above(offset(there->line, there->column), comment);
  const auto end = there->elements.empty()
                       ? offset(there->line, there->column) + 1
                       : offset(there->elements.back().end_line, there->elements.back().end_column);
  changes_.push_back({end, 0, (there->elements.empty() ? "{ " : ", { ") + line + " }"});
}

void TomlEdit::append_comment(const std::string& comment) { tail_ += "\n" + commented(comment); }

std::string TomlEdit::text() const {
  auto changes = changes_;
  std::stable_sort(changes.begin(), changes.end(),
                   [](const Change& a, const Change& b) { return a.at < b.at; });
  std::string result;
  std::size_t done = 0;
  for (const auto& change : changes) {
    require(change.at >= done, file_ + ": one value would be changed twice");
    result += text_.substr(done, change.at - done) + change.by;
    done = change.at + change.length;
  }
  result += text_.substr(done);
  if (!tail_.empty() && !result.empty() && result.back() != '\n') result += '\n';
  return result + tail_;
}

}  // namespace chladni::study
