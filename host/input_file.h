// A file that is read from its begin on.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "host/descriptor.h"

namespace chladni {

class InputFile {
 public:
  /// @throws InvalidInput    the file does not exist, is not a regular file or cannot be read
  /// @throws OutOfResources  the machine fails
  explicit InputFile(const std::filesystem::path& file);

  [[nodiscard]] std::size_t size() const { return size_; }  ///< when it was opened [bytes]
  /// Puts next bytes into `room`, and returns their number: 0 at the end alone.
  /// @throws InvalidInput, OutOfResources  as above
  [[nodiscard]] std::size_t read(char* room, std::size_t size);

 private:
  std::string name_;
  Descriptor source_;
  std::size_t size_ = 0;
};

}  // namespace chladni
