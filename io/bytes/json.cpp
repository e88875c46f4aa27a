// Reads JSON with nlohmann's parser. The writer is our own, because we want to fix the layout and
// the digits.
#include "io/json.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>
#include <unordered_set>

#include "base/error.h"
#include "host/atomic_file.h"
#include "io/bytes/escape.h"

namespace chladni::io {
namespace {

constexpr std::size_t kDeepest = 256;

const char* kind(const Json::Value& value) {
  constexpr std::array kinds{"null",     "a boolean", "a number", "a number",
                             "a string", "an array",  "an object"};
  return kinds[value.index()];
}

void append_escaped(std::string& out, char c) {
  constexpr std::string_view digits = "0123456789abcdef";
  const auto byte = static_cast<unsigned char>(c);
  switch (c) {
    case '"':
      out += "\\\"";
      return;
    case '\\':
      out += "\\\\";
      return;
    case '\n':
      out += "\\n";
      return;
    case '\r':
      out += "\\r";
      return;
    case '\t':
      out += "\\t";
      return;
    default:
      break;
  }
  if (byte < 0x20U || byte == 0x7FU) {
    out += "\\u00";
    out += digits[byte >> 4U];
    out += digits[byte & 15U];
  } else {
    out += c;
  }
}

// Bytes that are not UTF-8 become U+FFFD, so the file is valid for any names in a study.
void append_string(std::string& out, std::string_view text) {
  out += '"';
  for (const char c : valid_utf8(text)) append_escaped(out, c);
  out += '"';
}

// The shortest digits that read back as the same number. Whole numbers keep a ".0".
void append_number(std::string& out, double value) {
  if (!std::isfinite(value)) {
    out += "null";
    return;
  }
  std::array<char, 32> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  const std::string_view digits(buffer.data(), static_cast<std::size_t>(end - buffer.data()));
  out += digits;
  if (digits.find_first_of(".e") == std::string_view::npos) out += ".0";
}

bool is_container(const Json& json) {
  return std::holds_alternative<JsonArray>(json.value()) ||
         std::holds_alternative<JsonObject>(json.value());
}

void append(std::string& out, const Json& json, std::size_t level);

void append_line(std::string& out, std::size_t level) {
  out += '\n';
  out.append(2 * level, ' ');
}

void append_array(std::string& out, const JsonArray& array, std::size_t level) {
  bool flat = true;
  for (const Json& entry : array) flat = flat && !is_container(entry);
  out += '[';
  for (std::size_t i = 0; i < array.size(); ++i) {
    if (i > 0) out += flat ? ", " : ",";
    if (!flat) append_line(out, level + 1);
    append(out, array[i], level + 1);
  }
  if (!flat) append_line(out, level);
  out += ']';
}

void append_object(std::string& out, const JsonObject& object, std::size_t level) {
  out += '{';
  for (std::size_t i = 0; i < object.size(); ++i) {
    if (i > 0) out += ',';
    append_line(out, level + 1);
    append_string(out, object[i].first);
    out += ": ";
    append(out, object[i].second, level + 1);
  }
  if (!object.empty()) append_line(out, level);
  out += '}';
}

void append(std::string& out, const Json& json, std::size_t level) {
  const auto write = [&](const auto& value) {
    using T = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<T, std::monostate>) {
      out += "null";
    } else if constexpr (std::is_same_v<T, bool>) {
      out += value ? "true" : "false";
    } else if constexpr (std::is_same_v<T, long long>) {
      out += fmt::to_string(value);
    } else if constexpr (std::is_same_v<T, double>) {
      append_number(out, value);
    } else if constexpr (std::is_same_v<T, std::string>) {
      append_string(out, value);
    } else if constexpr (std::is_same_v<T, JsonArray>) {
      append_array(out, value, level);
    } else {
      append_object(out, value, level);
    }
  };
  std::visit(write, json.value());
}

// nlohmann's parser calls this class for each element (its SAX interface).
class Builder {
 public:
  bool null() { return add(Json()); }
  bool boolean(bool value) { return add(Json(value)); }
  bool number_integer(std::int64_t value) { return add(Json(static_cast<long long>(value))); }
  bool number_unsigned(std::uint64_t value) {
    const bool fits = value <= static_cast<std::uint64_t>(std::numeric_limits<long long>::max());
    return add(fits ? Json(static_cast<long long>(value)) : Json(static_cast<double>(value)));
  }
  bool number_float(double value, const std::string& /*as it stood*/) { return add(Json(value)); }
  bool string(std::string& value) { return add(Json(std::move(value))); }
  bool binary(std::vector<std::uint8_t>& /*not in text*/) { return false; }
  bool start_object(std::size_t /*unknown in text*/) { return open(false); }
  bool start_array(std::size_t /*unknown in text*/) { return open(true); }
  bool end_array() { return close(); }
  bool end_object() { return close(); }
  bool key(std::string& name) {
    require(open_.back().keys.insert(name).second, "JSON: key \"" + name + "\" is there twice");
    open_.back().key = std::move(name);
    return true;
  }
  bool parse_error(std::size_t position, const std::string& /*token*/,
                   const nlohmann::json::exception& error) {
    const std::string_view message = error.what();
    const std::size_t from = message.find("syntax error");
    throw InvalidInput(
        "not JSON: byte " + fmt::to_string(position) + ": " +
        std::string(from == std::string_view::npos ? message : message.substr(from)));
  }

  Json take() { return std::move(root_); }

 private:
  struct Open {  // an array or an object that has not ended yet
    bool is_array = false;
    JsonArray array;
    JsonObject object;
    std::unordered_set<std::string> keys;
    std::string key;
  };

  bool open(bool is_array) {
    require(open_.size() < kDeepest,
            "JSON: nested deeper than " + fmt::to_string(kDeepest) + " levels");
    open_.emplace_back().is_array = is_array;
    return true;
  }
  bool close() {
    Open done = std::move(open_.back());
    open_.pop_back();
    return add(done.is_array ? Json(std::move(done.array)) : Json(std::move(done.object)));
  }
  bool add(Json value) {
    if (open_.empty()) {
      root_ = std::move(value);
    } else if (open_.back().is_array) {
      open_.back().array.push_back(std::move(value));
    } else {
      open_.back().object.emplace_back(std::move(open_.back().key), std::move(value));
    }
    return true;
  }

  std::vector<Open> open_;
  Json root_;
};

}  // namespace

Json::Json(const Eigen::Ref<const Eigen::VectorXd>& vector)
    : value_(JsonArray(vector.begin(), vector.end())) {}

Json Json::texts(const std::vector<std::string>& lines) {
  return JsonArray(lines.begin(), lines.end());
}

Json Json::rows(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  JsonArray rows;
  for (const auto row : matrix.rowwise()) rows.emplace_back(JsonArray(row.begin(), row.end()));
  return Json(std::move(rows));
}

const Json& Json::at(const std::string& key) const {
  const auto* object = std::get_if<JsonObject>(&value_);
  require(object != nullptr,
          "JSON: \"" + key + "\" was asked of " + kind(value_) + ", expected an object");
  std::string there;
  for (const auto& [name, value] : *object) {
    if (name == key) return value;
    there += (there.empty() ? "" : ", ") + name;
  }
  throw InvalidInput("JSON: no key \"" + key + "\"; there are: " + there);
}

double Json::number() const {
  if (const auto* whole = std::get_if<long long>(&value_)) return static_cast<double>(*whole);
  const auto* number = std::get_if<double>(&value_);
  require(number != nullptr, std::string("JSON: found ") + kind(value_) + ", expected a number");
  return *number;
}

const std::string& Json::string() const {
  const auto* string = std::get_if<std::string>(&value_);
  require(string != nullptr, std::string("JSON: found ") + kind(value_) + ", expected a string");
  return *string;
}

const JsonArray& Json::array() const {
  const auto* array = std::get_if<JsonArray>(&value_);
  require(array != nullptr, std::string("JSON: found ") + kind(value_) + ", expected an array");
  return *array;
}

std::string text(const Json& json) {
  std::string out;
  append(out, json, 0);
  return out += '\n';
}

Json parse_json(const std::string& text) {
  Builder builder;
  if (!nlohmann::json::sax_parse(text, &builder)) throw InvalidInput("not JSON");
  return builder.take();
}

void write_json(const std::filesystem::path& file, const Json& json) {
  write_atomically(file, text(json));
}

}  // namespace chladni::io
