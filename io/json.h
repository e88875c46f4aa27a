// JSON values, written with all significant digits and with keys in the given order.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace chladni::io {

class Json;
using JsonArray = std::vector<Json>;
using JsonObject = std::vector<std::pair<std::string, Json>>;

/// null, bool, number, string, array or object. NaN and infinity are written as null.
class Json {
 public:
  Json() = default;
  /// Not the variant's: that of libstdc++ 12 destroys what is not made yet where a copy throws.
  Json(const Json& other) { value_ = other.value_; }
  Json(Json&&) noexcept = default;
  Json& operator=(const Json&) = default;
  Json& operator=(Json&&) noexcept = default;
  ~Json() = default;
  Json(bool value) : value_(value) {}
  Json(double value) : value_(value) {}
  Json(int value) : value_(static_cast<long long>(value)) {}
  Json(long value) : value_(static_cast<long long>(value)) {}
  Json(long long value) : value_(value) {}
  Json(const char* value) : value_(std::string(value)) {}
  /// A string of nullptr would throw, any other pointer would be true. Null is Json().
  Json(std::nullptr_t) = delete;
  template <typename T>
  Json(const T* value) = delete;
  Json(std::string value) : value_(std::move(value)) {}
  Json(JsonArray value) : value_(std::move(value)) {}
  Json(JsonObject value) : value_(std::move(value)) {}
  /// A vector as an array, a matrix as an array of its rows.
  Json(const Eigen::Ref<const Eigen::VectorXd>& vector);
  /// An array of strings.
  [[nodiscard]] static Json texts(const std::vector<std::string>& lines);
  [[nodiscard]] static Json rows(const Eigen::Ref<const Eigen::MatrixXd>& matrix);

  using Value =
      std::variant<std::monostate, bool, long long, double, std::string, JsonArray, JsonObject>;
  [[nodiscard]] const Value& value() const { return value_; }
  /// The member of an object. @throws InvalidInput  not an object, or no such key (lists the keys)
  [[nodiscard]] const Json& at(const std::string& key) const;
  [[nodiscard]] double number() const;              ///< @throws InvalidInput  not a number
  [[nodiscard]] const std::string& string() const;  ///< @throws InvalidInput  not a string
  [[nodiscard]] const JsonArray& array() const;     ///< @throws InvalidInput  not an array

 private:
  Value value_;
};

/// The JSON text with two spaces per level and arrays of numbers on one line. It ends with a
/// newline.
[[nodiscard]] std::string text(const Json& json);
/// Reads a JSON text. @throws InvalidInput  not JSON (names the place)
[[nodiscard]] Json parse_json(const std::string& text);
/// Writes the file whole or not at all. @throws as write_atomically
void write_json(const std::filesystem::path& file, const Json& json);

}  // namespace chladni::io
