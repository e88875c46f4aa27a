// A lock on one variant of a sweep, so that several sweeps may share a folder.
#pragma once

#include <filesystem>

namespace chladni::sweep {

/// Tries to lock a file, and holds the lock until the end. A process that dies leaves none.
class VariantLock {
 public:
  /// @throws OutOfResources  the file cannot be made
  explicit VariantLock(const std::filesystem::path& file);
  ~VariantLock();
  VariantLock(const VariantLock&) = delete;
  VariantLock& operator=(const VariantLock&) = delete;
  VariantLock(VariantLock&&) = delete;
  VariantLock& operator=(VariantLock&&) = delete;

  /// False if another process holds it.
  [[nodiscard]] bool is_held() const { return held_; }

 private:
  int descriptor_ = -1;
  bool held_ = false;
};

}  // namespace chladni::sweep
