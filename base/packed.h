// Values as bytes: what a result depends on, for its fingerprint, and results that are kept.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/error.h"

namespace chladni {

/// Appends values as they lie in memory; texts and arrays with their sizes before them, so that
/// different lists of values never give the same bytes. Bytes of one machine, no file format.
class Packed {
 public:
  template <typename Number>
  requires std::is_arithmetic_v<Number> Packed& add(Number value) {
    return raw(&value, sizeof value);
  }
  Packed& add(std::string_view text) {
    add(static_cast<std::uint64_t>(text.size()));
    return raw(text.data(), text.size());
  }
  Packed& add(const char* text) { return add(std::string_view(text)); }
  Packed& add(const std::vector<std::string>& texts) {
    add(static_cast<std::uint64_t>(texts.size()));
    for (const auto& text : texts) add(text);
    return *this;
  }
  template <typename Array>
  Packed& add(const Eigen::PlainObjectBase<Array>& array) {
    add(static_cast<std::int64_t>(array.rows())).add(static_cast<std::int64_t>(array.cols()));
    return raw(array.data(), static_cast<std::size_t>(array.size()) * sizeof(*array.data()));
  }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  Packed& raw(const void* from, std::size_t size) {
    if (size > 0) bytes_.append(static_cast<const char*>(from), size);
    return *this;
  }

  std::string bytes_;
};

/// Takes values in the order in which they were added. The bytes are not trusted: a size is
/// compared with what is left before memory is allocated.
/// All functions throw InvalidInput where the bytes end early or a size is not one.
class Unpacked {
 public:
  explicit Unpacked(std::string_view bytes) : rest_(bytes) {}

  template <typename Number>
  requires std::is_arithmetic_v<Number>
  [[nodiscard]] Number number() {
    Number value = {};
    raw(&value, sizeof value);
    return value;
  }
  [[nodiscard]] std::string text() {
    std::string value(size(1), '\0');
    raw(value.data(), value.size());
    return value;
  }
  [[nodiscard]] std::vector<std::string> texts() {
    std::vector<std::string> values(size(sizeof(std::uint64_t)));
    for (auto& value : values) value = text();
    return values;
  }
  template <typename Array>
  [[nodiscard]] Array array() {
    using Scalar = typename Array::Scalar;
    const auto rows = number<std::int64_t>();
    const auto columns = number<std::int64_t>();
    const auto most = static_cast<std::int64_t>(rest_.size() / sizeof(Scalar));
    const bool fits = rows >= 0 && columns >= 0 && rows <= kMostRows && columns <= kMostRows &&
                      (columns == 0 || rows <= most / columns);
    require(
        fits && agrees(rows, Array::RowsAtCompileTime) && agrees(columns, Array::ColsAtCompileTime),
        "packed values: an array with sizes that cannot be");
    Array value(rows, columns);
    raw(value.data(), static_cast<std::size_t>(value.size()) * sizeof(Scalar));
    return value;
  }
  [[nodiscard]] bool is_at_end() const { return rest_.empty(); }

 private:
  static constexpr std::int64_t kMostRows = std::int64_t{1} << 40;

  static bool agrees(std::int64_t size, int fixed) {
    return fixed == Eigen::Dynamic || size == fixed;
  }
  // A number of values of at least `bytes` each.
  std::size_t size(std::size_t bytes) {
    const auto count = number<std::uint64_t>();
    require(count <= rest_.size() / bytes, "packed values: cut off in a list");
    return static_cast<std::size_t>(count);
  }
  void raw(void* to, std::size_t size) {
    require(size <= rest_.size(), "packed values: cut off");
    if (size > 0) std::memcpy(to, rest_.data(), size);
    rest_.remove_prefix(size);
  }

  std::string_view rest_;
};

}  // namespace chladni
