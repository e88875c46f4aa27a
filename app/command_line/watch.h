// A verb that runs again whenever a file that it reads has changed (`--watch`).
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/command.h"

namespace chladni::app {

/// Files as they were at one moment, there or not. They are looked at ten times a second, which
/// works on every file system, and for editors that write in place as for those that rename.
class WatchedFiles {
 public:
  explicit WatchedFiles(std::vector<std::filesystem::path> files);

  /// Waits until some files are others than then and have not changed for 0.3 s, or for 1 s where
  /// one is gone: an editor may be about to write it.
  /// @return  those that changed, in their order
  /// @throws Interrupted  Ctrl-C and its like
  [[nodiscard]] std::vector<std::filesystem::path> wait_for_change() const;

  /// From now on the files for which `own` holds are expected as they are now: the run wrote them.
  void accept(const std::function<bool(const std::filesystem::path&)>& own);

  [[nodiscard]] const std::vector<std::filesystem::path>& files() const { return files_; }

 private:
  struct State {
    bool there = false;
    unsigned long long device = 0, node = 0;
    long long bytes = 0, seconds = 0, nanoseconds = 0;  // the time of the last change
    bool operator==(const State&) const = default;
  };
  [[nodiscard]] static State state_of(const std::filesystem::path& file);
  [[nodiscard]] std::vector<State> now() const;

  std::vector<std::filesystem::path> files_;
  std::vector<State> before_;  // per file
};

/// Whether a run of this verb may write the file itself: its results in `folder`, and the responses
/// that `simulate` makes. Studies are not written by a run that reads them.
[[nodiscard]] bool is_written(const Command& command, const std::filesystem::path& folder,
                              const std::filesystem::path& file);

/// What is watched, and how the verb is run.
struct Watch {
  /// The files that the next run will read, there or not; asked before each run.
  std::function<std::vector<std::filesystem::path>()> files;
  std::function<int()> run;  ///< shows its results and errors; returns the exit code
  /// Whether a run may write this file itself.
  std::function<bool(const std::filesystem::path&)> own;
  std::function<void(const std::string&)> note;  ///< hears what is waited for and what changed
};

/// Runs, waits for a change, runs again, and so on. An error of a run does not end it.
/// @return  the exit code of a run that was interrupted
/// @throws Interrupted  Ctrl-C and its like while it waits
[[nodiscard]] int run_at_each_change(const Watch& watch);

}  // namespace chladni::app
