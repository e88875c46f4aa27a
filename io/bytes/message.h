// What our programs say to each other over a pipe: JSON and arrays.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "base/arrays.h"
#include "io/json.h"

namespace chladni::io {

/// A head and named arrays. Not a file format: both ends are of one build.
struct Message {
  using Doubles = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  Json head;
  std::map<std::string, Doubles> doubles;
  std::map<std::string, Cells> integers;

  /// An array by its name. @throws InvalidInput  there is none of that name and type
  [[nodiscard]] const Doubles& numbers(const std::string& name) const;
  [[nodiscard]] const Cells& cells(const std::string& name) const;
};

/// The bytes: a line with the length of the JSON, the JSON, the arrays as they lie in memory.
[[nodiscard]] std::string bytes(const Message& message);

/// Whoever wrote the bytes is not trusted: sizes are whole numbers below 2³¹ and agree with what
/// there is before anything is allocated, each array is there once. What heads and values mean is
/// for the reader to check.
/// @throws InvalidInput  not such bytes; a length that does not agree with what there is
[[nodiscard]] Message message(std::string_view bytes);

}  // namespace chladni::io
