// Output for the user: a progress line, notes and warnings on stderr, results on stdout.
#pragma once

#include <chrono>
#include <iosfwd>
#include <string>
#include <string_view>

#include "base/progress.h"

namespace chladni::show {

/// Style of the output on a stream.
struct Manner {
  bool quiet = false;     ///< no notes and no progress, but warnings
  bool progress = false;  ///< the progress line: only if stderr is a terminal
  bool colour = false;    ///< bold and dim; not with NO_COLOR
};

/// The style that this process's stderr allows.
[[nodiscard]] Manner manner_of_stderr(bool quiet);

class Talk {
 public:
  Talk(std::ostream& stream, Manner manner) : stream_(stream), manner_(manner) {}

  void note(std::string_view line);     ///< not when quiet
  void warn(std::string_view message);  ///< "warning: ..."
  void error(std::string_view message);

  /// Draws "meshing  43 %" in place, at most ten times a second; empty if there is no terminal.
  [[nodiscard]] Progress progress();
  void clear_progress();

 private:
  void draw(std::string_view step, double fraction);
  [[nodiscard]] std::string painted(std::string_view text, std::string_view code) const;

  std::ostream& stream_;
  Manner manner_;
  bool drawn_ = false;
  std::string last_step_;
  std::chrono::steady_clock::time_point last_drawn_;
};

}  // namespace chladni::show
