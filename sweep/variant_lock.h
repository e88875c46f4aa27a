// A lock on one variant of a sweep, so that several sweeps may share a folder.
#pragma once

#include <filesystem>

#include "host/descriptor.h"

namespace chladni::sweep {

/// Tries to lock a file, and holds the lock until the end. A process that dies leaves none. On a
/// file system without locks there is none, and who shares a folder there solves some variants
/// twice.
class VariantLock {
 public:
  /// @throws OutOfResources, InvalidInput  the file cannot be made
  explicit VariantLock(const std::filesystem::path& file);

  /// Whether another process holds it.
  [[nodiscard]] bool is_elsewhere() const { return is_elsewhere_; }

 private:
  Descriptor lock_;
  bool is_elsewhere_ = false;
};

}  // namespace chladni::sweep
