// Numbers on the disk that do not fit the memory.
#pragma once

#include <cstddef>
#include <cstdint>

namespace chladni::io {

/// A file without a name: the system frees it when this goes, whatever ends the program. It lies in
/// TMPDIR, else in /var/tmp, which is a disk where /tmp may be memory.
class ScratchFile {
 public:
  /// @throws OutOfResources  no file can be made there
  ScratchFile();
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ScratchFile(ScratchFile&&) = delete;
  ScratchFile& operator=(ScratchFile&&) = delete;

  /// Writes at the end. @return where it begins [bytes]
  /// @throws OutOfResources  the disk is full, or the limit on the size of files is reached
  std::uint64_t append(const double* numbers, std::size_t count);
  /// @throws OutOfResources  the disk fails
  void read(std::uint64_t at, double* numbers, std::size_t count) const;

 private:
  int file_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace chladni::io
