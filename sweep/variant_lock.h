// A lock on one variant of a sweep, so that several sweeps may share a folder.
#pragma once

#include <filesystem>

namespace chladni::sweep {

/// Tries to lock a file, and holds the lock until the end. A process that dies leaves none. On a
/// file system without locks there is none, and who shares a folder there solves some variants
/// twice.
class VariantLock {
 public:
  /// @throws OutOfResources, InvalidInput  the file cannot be made
  explicit VariantLock(const std::filesystem::path& file);
  ~VariantLock();
  VariantLock(const VariantLock&) = delete;
  VariantLock& operator=(const VariantLock&) = delete;
  VariantLock(VariantLock&&) = delete;
  VariantLock& operator=(VariantLock&&) = delete;

  /// Whether another process holds it.
  [[nodiscard]] bool is_elsewhere() const { return is_elsewhere_; }

 private:
  int descriptor_ = -1;
  bool is_elsewhere_ = false;
};

}  // namespace chladni::sweep
