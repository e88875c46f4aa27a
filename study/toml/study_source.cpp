// The only file that uses toml++.
#include <fmt/format.h>

// Its headers alone, with TOML_FLOAT_CHARCONV: Debian's library reads numbers from a stream, which
// calls a number unreadable where memory lacks.
#include <toml++/toml.h>

#include <algorithm>
#include <functional>

#include "base/error.h"
#include "io/scan.h"
#include "study/toml/toml_tree.h"

namespace chladni::study {
namespace {

constexpr int kDeepest = 16;  // levels of nesting; a study needs five

TomlNode tree_of(const toml::node& node, const std::string& file, int depth);

TomlNode::Kind kind_of(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return TomlNode::Kind::table;
    case toml::node_type::array:
      return TomlNode::Kind::array;
    case toml::node_type::string:
      return TomlNode::Kind::text;
    case toml::node_type::integer:
      return TomlNode::Kind::integer;
    case toml::node_type::floating_point:
      return TomlNode::Kind::real;
    case toml::node_type::boolean:
      return TomlNode::Kind::truth;
    default:
      return TomlNode::Kind::date;
  }
}

std::string digits_of(double number) {
  std::string digits(32, '\0');
  const auto length = std::snprintf(digits.data(), digits.size(), "%.15g", number);
  digits.resize(static_cast<std::size_t>(length));
  return digits;
}

void take_value(const toml::node& node, TomlNode& out) {
  if (const auto* text = node.as_string()) out.text = text->get();
  if (const auto* truth = node.as_boolean()) out.truth = truth->get();
  if (const auto* real = node.as_floating_point()) {
    out.number = real->get();
    out.text = digits_of(out.number);
  }
  if (const auto* integer = node.as_integer()) {
    out.number = static_cast<double>(integer->get());
    out.text = fmt::to_string(integer->get());
  }
}

void take_members(const toml::table& table, const std::string& file, int depth, TomlNode& out) {
  for (const auto& [key, value] : table) {
    const auto place = key.source().begin;
    out.members.push_back({std::string(key.str()), static_cast<int>(place.line),
                           static_cast<int>(place.column), tree_of(value, file, depth + 1)});
  }
  // toml++ sorts by name, but the order of the file is better for messages and study.json.
  std::stable_sort(out.members.begin(), out.members.end(), [](const auto& a, const auto& b) {
    return std::pair(a.line, a.column) < std::pair(b.line, b.column);
  });
}

TomlNode tree_of(const toml::node& node, const std::string& file, int depth) {
  TomlNode out;
  out.kind = kind_of(node);
  out.line = static_cast<int>(node.source().begin.line);
  out.column = static_cast<int>(node.source().begin.column);
  out.end_line = static_cast<int>(node.source().end.line);
  out.end_column = static_cast<int>(node.source().end.column);
  require(depth <= kDeepest, file + ":" + fmt::to_string(out.line) + ":" +
                                 fmt::to_string(out.column) + ": nested more than 16 deep");
  take_value(node, out);
  if (const auto* table = node.as_table()) take_members(*table, file, depth, out);
  if (const auto* array = node.as_array()) {
    for (const auto& element : *array) out.elements.push_back(tree_of(element, file, depth + 1));
  }
  return out;
}

// Where the text that begins at `i` has ended: behind its last quote, or at the end of the line.
std::size_t behind_text(std::string_view bytes, std::size_t i) {
  const char quote = bytes[i];
  const std::string three(3, quote);
  const bool is_long = bytes.substr(i, 3) == three;
  for (i += is_long ? 3 : 1; i < bytes.size(); ++i) {
    if (bytes[i] == '\\' && quote == '"') {
      ++i;
    } else if (is_long ? bytes.substr(i, 3) == three : bytes[i] == quote) {
      return i + (is_long ? 3 : 1);
    } else if (!is_long && bytes[i] == '\n') {
      return i;
    }
  }
  return bytes.size();
}

bool continues(char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U; }

bool is_beyond_ascii(char byte) { return static_cast<unsigned char>(byte) >= 0x80U; }

// The same with an x for each letter beyond ASCII.
std::string with_plain_letters(std::string_view bytes) {
  std::string plain;
  for (const char byte : bytes) {
    if (!continues(byte)) plain += is_beyond_ascii(byte) ? 'x' : byte;
  }
  return plain;
}

// toml++ is undefined for some letters beyond ASCII (ü, U+FEBB) where no text and no comment is.
// In a file whose texts begin and end as they should these are all that it may meet there.
void refuse_letters_outside_texts(std::string_view bytes, const std::string& file) {
  std::size_t i = 0;
  while (i < bytes.size()) {
    if (bytes[i] == '"' || bytes[i] == '\'') {
      i = behind_text(bytes, i);
    } else if (bytes[i] == '#') {
      i = std::min(bytes.find('\n', i), bytes.size());
    } else if (!is_beyond_ascii(bytes[i])) {
      ++i;
    } else {
      break;
    }
  }
  if (i >= bytes.size()) return;
  const auto before = bytes.substr(0, i);
  const auto from = before.rfind('\n') + 1;  // 0 in the first line
  const auto column = 1 + std::ranges::count_if(before.substr(from), std::not_fn(continues));
  std::size_t end = i + 1;
  while (end < bytes.size() && end < i + 4 && continues(bytes[end])) ++end;
  throw InvalidInput(
      fmt::format("{}:{}:{}: '{}' stands outside of a text: keys and values are of "
                  "plain letters, digits and signs; a text stands in quotes",
                  file, 1 + std::ranges::count(before, '\n'), column, bytes.substr(i, end - i)));
}

}  // namespace

std::string description(const TomlNode& node) {
  switch (node.kind) {
    case TomlNode::Kind::table:
      return "a table";
    case TomlNode::Kind::array:
      return "an array of " + fmt::to_string(node.elements.size()) + " values";
    case TomlNode::Kind::text:
      return "the text \"" + node.text + "\"";
    case TomlNode::Kind::integer:
    case TomlNode::Kind::real:
      return "the number " + node.text;
    case TomlNode::Kind::truth:
      return node.truth ? "true" : "false";
    default:
      return "a date or time";
  }
}

TomlNode parse_toml(std::string_view bytes, const std::string& file) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";  // of UTF-8, at the start of a file
  io::refuse_utf16(bytes, file);
  if (bytes.starts_with(kMark)) bytes.remove_prefix(kMark.size());
  refuse_letters_outside_texts(bytes, file);
  try {
    if (std::ranges::any_of(bytes, is_beyond_ascii)) (void)toml::parse(with_plain_letters(bytes));
    return tree_of(toml::parse(bytes), file, 0);  // a name it copies where nothing may be thrown
  } catch (const toml::parse_error& e) {
    const auto place = e.source().begin;
    throw InvalidInput(file + ":" + fmt::to_string(place.line) + ":" +
                       fmt::to_string(place.column) + ": " + std::string(e.description()));
  }
}

}  // namespace chladni::study
