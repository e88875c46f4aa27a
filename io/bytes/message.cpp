#include "io/bytes/message.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstring>

#include "base/error.h"

namespace chladni::io {
namespace {

constexpr std::string_view kMagic = "chladni-message ";

template <class Array>
void describe(const std::map<std::string, Array>& arrays, const char* type, JsonArray& list) {
  for (const auto& [name, array] : arrays) {
    list.emplace_back(JsonObject{
        {"name", name}, {"type", type}, {"rows", array.rows()}, {"columns", array.cols()}});
  }
}

template <class Array>
void append(const std::map<std::string, Array>& arrays, std::string& out) {
  for (const auto& [name, array] : arrays) {
    const auto size = static_cast<std::size_t>(array.size()) * sizeof(typename Array::Scalar);
    out.append(reinterpret_cast<const char*>(array.data()), size);
  }
}

// A number of rows or columns. The limit of 2³¹ also holds for empty arrays.
Eigen::Index count_of(const Json& description, const char* key, const std::string& name) {
  constexpr double most = 2147483647.0;
  const double count = description.at(key).number();
  require(count >= 0.0 && count <= most && count == std::floor(count),
          "message: array \"" + name + "\" has " + fmt::to_string(count) + " " + key +
              ", expected a whole number from 0 to " + fmt::to_string(2147483647));
  return static_cast<Eigen::Index>(count);
}

// Takes an array from the front of `bytes`. Its size is checked before memory is allocated.
template <class Array>
Array taken(std::string_view& bytes, const Json& description) {
  const std::string& name = description.at("name").string();
  const Eigen::Index rows = count_of(description, "rows", name);
  const Eigen::Index columns = count_of(description, "columns", name);
  const auto there = static_cast<Eigen::Index>(bytes.size() / sizeof(typename Array::Scalar));
  require(columns == 0 || rows <= there / columns,
          "message: array \"" + name + "\" of " + fmt::to_string(rows) + " x " +
              fmt::to_string(columns) + " numbers is longer than what there is, " +
              fmt::to_string(bytes.size()) + " bytes");
  Array array(rows, columns);
  const auto byte_count = static_cast<std::size_t>(array.size()) * sizeof(typename Array::Scalar);
  if (byte_count > 0) std::memcpy(array.data(), bytes.data(), byte_count);
  bytes.remove_prefix(byte_count);
  return array;
}

template <class Array>
void add(std::map<std::string, Array>& arrays, std::string_view& bytes, const Json& description) {
  const std::string& name = description.at("name").string();
  require(arrays.emplace(name, taken<Array>(bytes, description)).second,
          "message: there are two arrays \"" + name + "\"");
}

template <class Array>
std::size_t byte_count(const std::map<std::string, Array>& arrays) {
  std::size_t count = 0;
  for (const auto& [name, array] : arrays) {
    count += static_cast<std::size_t>(array.size()) * sizeof(typename Array::Scalar);
  }
  return count;
}

template <class Array>
const Array& named(const std::map<std::string, Array>& arrays, const std::string& name) {
  const auto found = arrays.find(name);
  require(found != arrays.end(), "message: there is no array \"" + name + "\"");
  return found->second;
}

}  // namespace

const Message::Doubles& Message::numbers(const std::string& name) const {
  return named(doubles, name);
}

const Cells& Message::cells(const std::string& name) const { return named(integers, name); }

std::string bytes(const Message& message) {
  JsonArray arrays;
  describe(message.doubles, "f64", arrays);
  describe(message.integers, "i32", arrays);
  const std::string json = text(JsonObject{{"head", message.head}, {"arrays", std::move(arrays)}});
  std::string out;
  out.reserve(64 + json.size() + byte_count(message.doubles) + byte_count(message.integers));
  out.append(kMagic).append(fmt::to_string(json.size())).append("\n").append(json);
  append(message.doubles, out);
  append(message.integers, out);
  return out;
}

Message message(std::string_view bytes) {
  require(bytes.starts_with(kMagic), "message: it does not begin as one");
  bytes.remove_prefix(kMagic.size());
  std::size_t length = 0;
  const auto [end, error] = std::from_chars(bytes.data(), bytes.data() + bytes.size(), length);
  require(error == std::errc() && end != bytes.data() + bytes.size() && *end == '\n',
          "message: the length of its head is missing");
  bytes.remove_prefix(static_cast<std::size_t>(end - bytes.data()) + 1);
  require(length <= bytes.size(), "message: cut off in its head");
  const Json json = parse_json(std::string(bytes.substr(0, length)));
  bytes.remove_prefix(length);

  Message result;
  result.head = json.at("head");
  for (const Json& array : json.at("arrays").array()) {
    const std::string& type = array.at("type").string();
    require(type == "f64" || type == "i32",
            "message: an array of \"" + type + "\", expected f64 or i32");
    if (type == "f64") {
      add(result.doubles, bytes, array);
    } else {
      add(result.integers, bytes, array);
    }
  }
  require(bytes.empty(), "message: there are bytes after its end");
  return result;
}

}  // namespace chladni::io
