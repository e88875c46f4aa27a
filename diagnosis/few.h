// A short list that is known when the program is compiled.
#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>

namespace chladni::diagnosis {

/// At most `most` values. Unlike a std::vector it lets what holds it be a constant, which statics
/// of other files may use before main.
template <typename T, std::size_t most>
class Few {
 public:
  constexpr Few() = default;
  constexpr Few(std::initializer_list<T> values) {
    for (const auto& value : values) push_back(value);
  }
  /// @pre  size() < most
  constexpr void push_back(const T& value) { all_.at(count_++) = value; }

  [[nodiscard]] constexpr const T* begin() const { return all_.data(); }
  [[nodiscard]] constexpr const T* end() const { return all_.data() + count_; }
  [[nodiscard]] constexpr std::size_t size() const { return count_; }
  [[nodiscard]] constexpr bool empty() const { return count_ == 0; }

 private:
  std::array<T, most> all_{};
  std::size_t count_ = 0;
};

}  // namespace chladni::diagnosis
