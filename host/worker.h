// Runs a worker program behind a pipe, with limits. Workers hold libraries that abort, crash or
// hang.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace chladni {

struct WorkerLimits {
  std::chrono::seconds time{120};                    ///< wall time, then SIGKILL
  std::size_t memory_bytes = std::size_t{8} << 30U;  ///< RLIMIT_AS of the worker; 0: no limit
  /// Limit of the worker's stdout, or a quarter of the available memory where that is less; a
  /// worker that writes more is killed with SIGKILL.
  std::size_t output_bytes = std::size_t{4} << 30U;
  /// SIGTERM comes so long before SIGKILL, for a program that has others to end. 0: none comes.
  std::chrono::milliseconds grace{0};
  /// Whether it is confined (host/confinement.h), as what meets foreign bytes should be, with the
  /// files that it may read. Not for a program that starts others or needs a display.
  bool confined = false;
  std::vector<std::filesystem::path> files{};
};

/// The worker's answer is not that of a worker of this build. So the cause is not an input file.
class UnusableReply : public WorkerDied {
 public:
  using WorkerDied::WorkerDied;
};

struct WorkerResult {
  std::string output;  ///< everything that the worker wrote to stdout
  std::string errors;  ///< the last 64 KiB that it wrote to stderr
};

/// A confined worker asked the system for what it may not do. Its input made it do so.
class ForbiddenCall : public WorkerDied {
 public:
  using WorkerDied::WorkerDied;
};

/// Starts `program arguments...`, writes `input` to its stdin, and reads its stdout and stderr
/// until the program ends. Ctrl-C kills the program within 0.2 s.
/// @throws WorkerDied    it could not start, ended by a signal or with a status other than 0, or
///                       exceeded a limit; the message names the program's file name and how it
///                       ended ("mesher died: signal 6 (Aborted)", "... within 120 s"), then the
///                       last line of its stderr
/// @throws UnusableReply   it wrote more than `limits.output_bytes`
/// @throws ForbiddenCall   it was confined, and was stopped for what it tried
/// @throws OutOfResources  there is no memory for its output
/// @throws Interrupted     Ctrl-C
[[nodiscard]] WorkerResult run_worker(const std::filesystem::path& program,
                                      const std::vector<std::string>& arguments,
                                      std::string_view input, const WorkerLimits& limits = {});

/// As run_worker, but an exit status other than 0 is an answer too. It is put into `status`.
[[nodiscard]] WorkerResult run_program(const std::filesystem::path& program,
                                       const std::vector<std::string>& arguments, int& status,
                                       const WorkerLimits& limits = {});

/// Returns read(), which reads the reply of `worker`.
/// @throws UnusableReply  `read` refuses the reply (InvalidInput or another logic error); says why
template <class Read>
auto reply_of(const std::filesystem::path& worker, Read read) {
  try {
    return read();
  } catch (const std::logic_error& fault) {
    throw UnusableReply(worker.filename().string() + " gave a reply that cannot be used: " +
                        fault.what() + "; is it of this build? (" + worker.string() + ")");
  }
}

/// Tries whether `program` can run, confined or not: starts it without input and waits for its end,
/// 10 s at most.
/// Any exit status counts as success, except 127: the program's libraries are missing.
/// @throws WorkerDied  the program could not start, was ended by a signal, had the exit status 127
///                     or did not end in time
void try_worker(const std::filesystem::path& program, bool confined = false);

/// The path of a worker program. These folders are searched in order: $CHLADNI_LIBEXEC, the added
/// folders, the folder of the running binary, libexec/chladni beside this folder, and the install
/// tree's libexec/chladni.
/// @throws WorkerDied  none of the folders has such a file (lists the folders)
[[nodiscard]] std::filesystem::path worker_path(std::string_view name);

/// The program of that name in the folders of $PATH, or the path itself where it has a slash.
/// Nothing where there is no such program.
[[nodiscard]] std::optional<std::filesystem::path> program_on_path(const std::string& name);

/// Adds a folder to the search of `worker_path`. This is for a library that another program, such
/// as Python, has loaded. Do not call it while another thread calls `worker_path`.
void add_worker_folder(const std::filesystem::path& folder);

}  // namespace chladni
