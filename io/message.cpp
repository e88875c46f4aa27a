#include "io/message.h"

#include <charconv>
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

// Takes an array off the front of `bytes`; its size is checked before anything is allocated.
template <class Array>
Array taken(std::string_view& bytes, const Json& description) {
  const double rows = description.at("rows").number();
  const double columns = description.at("columns").number();
  const double size = rows * columns * static_cast<double>(sizeof(typename Array::Scalar));
  require(
      rows >= 0.0 && columns >= 0.0 && size <= static_cast<double>(bytes.size()),
      "message: array \"" + description.at("name").string() + "\" is longer than what there is");
  Array array(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
  const auto byte_count = static_cast<std::size_t>(size);
  if (byte_count > 0) std::memcpy(array.data(), bytes.data(), byte_count);
  bytes.remove_prefix(byte_count);
  return array;
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
  std::string out = std::string(kMagic) + std::to_string(json.size()) + "\n" + json;
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
    const std::string& name = array.at("name").string();
    if (array.at("type").string() == "f64") {
      result.doubles[name] = taken<Message::Doubles>(bytes, array);
    } else {
      result.integers[name] = taken<Cells>(bytes, array);
    }
  }
  require(bytes.empty(), "message: there are bytes after its end");
  return result;
}

}  // namespace chladni::io
