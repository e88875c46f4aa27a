// Large arrays of doubles, taken directly from the operating system.
#pragma once

#include <cstddef>
#include <cstdint>

namespace chladni::fem {

/// An array that the destructor gives back to the system. The array is zero at first, and resident
/// only where it was written. The pages have the usual size. With huge pages the first touch cost
/// up to seven times as much in a virtual machine, and the matrix products, which copy their
/// factors, gained nothing.
class Storage {
 public:
  Storage() = default;
  /// @param resident  makes all pages resident at once, at half the cost of page by page
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
  /// Gives back to the system what lies behind the first `doubles`.
  void shrink(std::int64_t doubles);

 private:
  void swap(Storage& other);
  std::size_t bytes_ = 0;
  double* data_ = nullptr;
};

/// A stack of blocks: blocks are given back in the opposite order in which they were taken.
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
