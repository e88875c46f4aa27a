// Errors with their place: the line of the file with a caret, and as JSON.
#pragma once

#include <string>
#include <vector>

#include "io/json.h"
#include "stage/remedies.h"

namespace chladni::show {

/// A line of a message such as "study.toml:12:8: ...". Without a place line and column are 0.
struct PlacedError {
  std::string file;
  int line = 0, column = 0;
  std::string message;  ///< without the place
};

/// The lines of a message, one error each. A line without a place belongs to the error before it
/// where that has one.
[[nodiscard]] std::vector<PlacedError> placed_errors(const std::string& message);

/// The message; behind each line that has a place follows the line of its file, with a caret below
/// the column. A file that cannot be read is left out.
[[nodiscard]] std::string with_excerpts(const std::string& message);

/// { "error": { "exit": 3, "errors": [ { "file", "line", "column", "message" } ] } }; where there
/// are remedies also "remedies": [ { "kind", "study", "options", ... } ], of which "study" has the
/// keys to write. The members of `result`, the text of an object that a verb left before it failed,
/// stand in front; empty: none.
/// @throws InvalidInput  `result` is not JSON
[[nodiscard]] io::Json error_json(const std::string& message, int exit,
                                  const std::vector<stage::Remedy>& remedies = {},
                                  const std::string& result = "");

}  // namespace chladni::show
