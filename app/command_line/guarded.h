// What becomes of an error: a message, JSON where that was asked for, and an exit code.
#pragma once

#include <functional>

#include "base/text_stream.h"
#include "show/run.h"

namespace chladni::app {

/// How an error is told.
struct ErrorStyle {
  bool excerpts = true;  ///< with the line of the file that it names
  bool json = false;     ///< on the standard output too, in one object with the result
  const TextWriter* result = nullptr;  ///< JSON that the verb had left before
};

/// Runs `work` and turns any exception into a message and an exit code.
[[nodiscard]] int guarded(show::Talk& talk, const std::function<int()>& work,
                          const ErrorStyle& style = {});

}  // namespace chladni::app
