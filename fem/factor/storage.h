// Large arrays of doubles straight from the system.
#pragma once

#include <cstddef>
#include <cstdint>

namespace chladni::fem {

/// Memory that is given back when it is no longer held; zero at first, and resident only where it
/// was written. Pages of the usual size: in huge ones the first touch cost up to seven times as
/// much in a virtual machine, and the products, which copy what they multiply, gained nothing.
class Storage {
 public:
  Storage() = default;
  /// @param resident  all of it at once, which costs half of what page by page does
  /// @throws OutOfResources  the system grants no such range
  explicit Storage(std::int64_t doubles, bool resident = false);
  ~Storage();
  Storage(const Storage&) = delete;
  Storage& operator=(const Storage&) = delete;
  Storage(Storage&& other) noexcept { swap(other); }
  Storage& operator=(Storage&& other) noexcept {
    swap(other);
    return *this;
  }
  [[nodiscard]] double* data() const { return data_; }

 private:
  void swap(Storage& other);
  std::size_t bytes_ = 0;
  double* data_ = nullptr;
};

/// Blocks that are given back in the opposite order they were taken in.
class Stack {
 public:
  Stack() = default;
  explicit Stack(std::int64_t doubles) : storage_(doubles) {}
  [[nodiscard]] double* push(std::int64_t doubles) {
    double* block = storage_.data() + top_;
    top_ += doubles;
    return block;
  }
  void pop(std::int64_t doubles) { top_ -= doubles; }

 private:
  Storage storage_;
  std::int64_t top_ = 0;
};

}  // namespace chladni::fem
