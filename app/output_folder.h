// The folder a run writes to, held by one run at a time.
#pragma once

#include <filesystem>

namespace chladni::app {

/// Creates `folder`, makes sure that it can be written, and holds a lock with this process's number
/// in it until the end; a run that dies leaves no lock behind.
class OutputFolder {
 public:
  /// @throws InvalidInput  it cannot be made or written, or another run holds it (names that
  /// process)
  /// @throws OutOfResources  the disk is full
  explicit OutputFolder(const std::filesystem::path& folder);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  OutputFolder(OutputFolder&&) = delete;
  OutputFolder& operator=(OutputFolder&&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }

 private:
  std::filesystem::path folder_, lock_;
  int descriptor_ = -1;
};

}  // namespace chladni::app
