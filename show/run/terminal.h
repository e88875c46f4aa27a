// Output for the user: a progress line, notes and warnings on stderr, results on stdout.
#pragma once

#include <chrono>
#include <condition_variable>
#include <iosfwd>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "base/progress.h"

namespace chladni::show {

/// Style of the output on a stream.
struct Manner {
  bool quiet = false;     ///< no notes and no progress, but warnings
  bool progress = false;  ///< the progress line: only if stderr is a terminal
  bool lines = false;     ///< a line of progress every so often, where it is none
  bool colour = false;    ///< bold and dim; not with NO_COLOR
  bool all = false;       ///< warnings that differ in numbers and names alone are not folded
  std::chrono::milliseconds every{15000};  ///< between two lines of progress
};

/// The style that this process's stderr allows.
[[nodiscard]] Manner manner_of_stderr(bool quiet);

/// Tells the first three of the warnings and notes that differ in numbers and quoted names alone,
/// and at the end how many there were besides. A step in which nothing is heard of its progress is
/// told with the time that it takes, by a thread of its own.
class Talk {
 public:
  Talk(std::ostream& stream, Manner manner) : stream_(stream), manner_(manner) {}
  /// Tells how many warnings and notes were folded.
  ~Talk();
  Talk(const Talk&) = delete;
  Talk& operator=(const Talk&) = delete;
  Talk(Talk&&) = delete;
  Talk& operator=(Talk&&) = delete;

  void note(std::string_view line);     ///< not when quiet
  void warn(std::string_view message);  ///< "warning: ..."
  void error(std::string_view message);

  /// Draws "meshing  43 %  12 s" in place, at most ten times a second. Where there is no terminal:
  /// a line with the step and the time since the beginning, at most every 15 s.
  [[nodiscard]] Progress progress();
  void clear_progress();
  /// As the destructor, for a stream that is read before it.
  void tell_folded();

 private:
  using Clock = std::chrono::steady_clock;

  void heard(std::string_view step, double fraction);
  void draw();
  void write_line();
  void tick();
  void clear();
  [[nodiscard]] bool is_folded(std::string_view kind, std::string_view message);
  [[nodiscard]] std::string painted(std::string_view text, std::string_view code) const;

  std::ostream& stream_;
  Manner manner_;
  std::mutex mutex_;  // of all below
  bool drawn_ = false;
  std::string step_;
  double fraction_ = -1.0;
  Clock::time_point begin_ = Clock::now(), step_begin_, last_drawn_;
  struct Fold {
    std::string first;
    int count = 0;
  };
  std::map<std::string, Fold> folds_;
  std::condition_variable ended_;
  bool ends_ = false;
  std::thread ticker_;
};

}  // namespace chladni::show
