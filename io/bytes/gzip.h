// Compressed files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "host/input_file.h"

namespace chladni::io {

/// Whether the bytes begin like a gzip file.
[[nodiscard]] bool is_gzip(std::string_view bytes);

/// The unpacked content of one gzip file, or of several gzip files one after the other, which zeros
/// may follow.
/// @throws InvalidInput  the file is damaged or truncated, other bytes follow its end, or its
///                       content exceeds `limit` bytes
[[nodiscard]] std::string unzipped(std::string_view bytes, std::size_t limit);

class Inflation;

/// The content of a file of any size, from its begin to its end; of a gzip file the unpacked one.
class UnpackedFile {
 public:
  /// @throws InvalidInput, OutOfResources  as InputFile
  explicit UnpackedFile(const std::filesystem::path& file);
  ~UnpackedFile();
  UnpackedFile(const UnpackedFile&) = delete;
  UnpackedFile& operator=(const UnpackedFile&) = delete;
  UnpackedFile(UnpackedFile&&) = delete;
  UnpackedFile& operator=(UnpackedFile&&) = delete;

  /// Puts the next bytes into `room`, and returns their number: less than it holds at the end
  /// alone.
  /// @throws InvalidInput    it is damaged or truncated, or other bytes follow its end
  /// @throws OutOfResources  as InputFile
  [[nodiscard]] std::size_t read(char* room, std::size_t size);
  [[nodiscard]] bool is_packed() const { return inflation_ != nullptr; }

 private:
  std::size_t read_packed(char* room, std::size_t size);
  void refill();  ///< left_; empty: the file is at its end

  std::string name_;
  InputFile in_;
  std::unique_ptr<Inflation> inflation_;  // none: the file is not packed
  std::vector<char> packed_;
  std::string_view left_;  // of packed_
};

/// CRC-32 of the bytes, as gzip and PNG have it (ISO/IEC 15948, annex D). Cost: linear.
[[nodiscard]] std::uint32_t checksum(std::string_view bytes);

}  // namespace chladni::io
