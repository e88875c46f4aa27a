// Reals have the fewest digits that give the same number again.
#include "study/toml/toml_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"

namespace chladni::study {
namespace {

bool is_bare(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-';
}

std::string key_text(const std::string& key) {
  return !key.empty() && std::ranges::all_of(key, is_bare) ? key : toml_text(key);
}

std::string real_text(double number) {
  auto text = fmt::format("{}", number);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";  // 1e300, inf and nan are real
  return text;
}

std::string inline_text(const TomlNode& node) {
  std::string out;
  switch (node.kind) {
    case TomlNode::Kind::text:
      return toml_text(node.text);
    case TomlNode::Kind::integer:
      return node.text;
    case TomlNode::Kind::real:
      return real_text(node.number);
    case TomlNode::Kind::truth:
      return node.truth ? "true" : "false";
    case TomlNode::Kind::array:
      for (const auto& element : node.elements) {
        out += (out.empty() ? "" : ", ") + inline_text(element);
      }
      return "[" + out + "]";
    case TomlNode::Kind::table:
      for (const auto& [key, line, column, value] : node.members) {
        out += (out.empty() ? " " : ", ") + key_text(key) + " = " + inline_text(value);
      }
      return "{" + out + (out.empty() ? "}" : " }");
    default:
      throw InvalidInput("a date or time has no place in a study");
  }
}

bool is_tables(const TomlNode& node) {
  return node.kind == TomlNode::Kind::array && !node.elements.empty() &&
         std::ranges::all_of(node.elements,
                             [](const auto& e) { return e.kind == TomlNode::Kind::table; });
}

std::string lines_of(const TomlNode& table) {
  std::string out;
  for (const auto& member : table.members) {
    out += key_text(member.key) + " = " + inline_text(member.value) + "\n";
  }
  return out;
}

}  // namespace

std::string toml_text(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20U || c == 0x7F) {
      result += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
      continue;
    }
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + '"';
}

std::string toml_text(const TomlNode& document) {
  std::string values;
  std::string tables;
  for (const auto& member : document.members) {
    const auto key = key_text(member.key);
    if (member.value.kind == TomlNode::Kind::table) {
      tables += "\n[" + key + "]\n" + lines_of(member.value);
    } else if (is_tables(member.value)) {
      for (const auto& element : member.value.elements) {
        tables += "\n[[" + key + "]]\n" + lines_of(element);
      }
    } else {
      values += key + " = " + inline_text(member.value) + "\n";
    }
  }
  return values + tables;
}

}  // namespace chladni::study
