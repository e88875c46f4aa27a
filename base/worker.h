// A program of our own behind a pipe, with limits: for libraries that abort, crash or hang.
#pragma once

#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace chladni {

struct WorkerLimits {
  std::chrono::seconds time{120};                    ///< wall time, then SIGKILL
  std::size_t memory_bytes = std::size_t{8} << 30U;  ///< RLIMIT_AS of the worker; 0: no limit
  /// Of its stdout, then SIGKILL; a quarter of the memory that there is where that is less.
  std::size_t output_bytes = std::size_t{4} << 30U;
};

/// The worker answered, but not as a worker of this build does: the fault is no file's.
class UnusableReply : public WorkerDied {
 public:
  using WorkerDied::WorkerDied;
};

struct WorkerResult {
  std::string output;  ///< all it wrote to stdout
  std::string errors;  ///< the last 64 KiB it wrote to stderr
};

/// Starts `program arguments...`, writes `input` to its stdin, reads its stdout and stderr until it
/// ends. Ctrl-C kills it within 0.2 s.
/// @throws WorkerDied    it could not start, ended by a signal or with a status other than 0, or
///                       exceeded a limit; the message names the program's file name and how it
///                       ended ("mesher died: signal 6 (Aborted)", "... within 120 s"), then the
///                       last line of its stderr
/// @throws UnusableReply   it wrote more than `limits.output_bytes`
/// @throws OutOfResources  there is no memory for what it writes
/// @throws Interrupted     Ctrl-C
[[nodiscard]] WorkerResult run_worker(const std::filesystem::path& program,
                                      const std::vector<std::string>& arguments,
                                      std::string_view input, const WorkerLimits& limits = {});

/// What `read()` makes of the reply of `worker`.
/// @throws UnusableReply  where `read` refuses it (InvalidInput or another logic error); says why
template <class Read>
auto reply_of(const std::filesystem::path& worker, Read read) {
  try {
    return read();
  } catch (const std::logic_error& fault) {
    throw UnusableReply(worker.filename().string() + " gave a reply that cannot be used: " +
                        fault.what() + "; is it of this build? (" + worker.string() + ")");
  }
}

/// Starts `program` with nothing to do and waits for its end, 10 s at most. Any exit status is an
/// answer, but for 127: that of a program whose libraries are missing.
/// @throws WorkerDied  it could not be started, or a signal ended it
void try_worker(const std::filesystem::path& program);

/// Where a worker of ours lives: $CHLADNI_LIBEXEC, else a folder that was added, else beside the
/// running binary, else the install tree's libexec/chladni.
/// @throws WorkerDied  there is no such file in any of them (lists them)
[[nodiscard]] std::filesystem::path worker_path(std::string_view name);

/// A folder that `worker_path` looks in: for a library that is loaded by a program which is not
/// ours, such as Python. Not to be called while another thread calls `worker_path`.
void add_worker_folder(const std::filesystem::path& folder);

}  // namespace chladni
