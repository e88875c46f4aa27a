// The output folder of a run. Only one run can hold it at a time.
#pragma once

#include <filesystem>

#include "host/descriptor.h"

namespace chladni::show {

/// Creates `folder`, checks that it can be written, and holds a lock with this process's number
/// until the end. A run that crashes leaves no lock.
class OutputFolder {
 public:
  /// @throws InvalidInput  it cannot be created or written, or another run holds it (names that
  ///                       process)
  /// @throws OutOfResources  the disk is full
  explicit OutputFolder(const std::filesystem::path& folder);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  OutputFolder(OutputFolder&&) = delete;
  OutputFolder& operator=(OutputFolder&&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }
  /// When this run took the folder, by the clock of its file system.
  [[nodiscard]] std::filesystem::file_time_type began() const {
    return std::filesystem::last_write_time(lock_);
  }

 private:
  std::filesystem::path folder_, lock_;
  Descriptor descriptor_;
};

}  // namespace chladni::show
