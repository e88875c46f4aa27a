// Messages between our programs over a pipe: JSON and arrays.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "base/arrays.h"
#include "io/json.h"

namespace chladni::io {

/// A head and named arrays. This is not a file format: both programs belong to one build.
struct Message {
  using Doubles = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  Json head;
  std::map<std::string, Doubles> doubles;
  std::map<std::string, Cells> integers;

  /// An array by its name. @throws InvalidInput  there is no array with that name and type
  [[nodiscard]] const Doubles& numbers(const std::string& name) const;
  [[nodiscard]] const Cells& cells(const std::string& name) const;
};

/// The bytes: a line with the length of the JSON, then the JSON, then the arrays as in memory.
[[nodiscard]] std::string bytes(const Message& message);

/// Reads a message. The writer is not trusted: before memory is allocated, sizes must be whole
/// numbers below 2³¹ and agree with the number of bytes. Each array occurs once. The caller must
/// check the meaning of the head and the values.
/// @throws InvalidInput  not such bytes, or a length that does not agree with the bytes
[[nodiscard]] Message message(std::string_view bytes);

}  // namespace chladni::io
