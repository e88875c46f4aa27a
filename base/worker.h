// A program of our own behind a pipe, with limits: for libraries that abort, crash or hang.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace chladni {

struct WorkerLimits {
  std::chrono::seconds time{120};                    ///< wall time, then SIGKILL
  std::size_t memory_bytes = std::size_t{8} << 30U;  ///< RLIMIT_AS of the worker; 0: no limit
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
/// @throws Interrupted   Ctrl-C
[[nodiscard]] WorkerResult run_worker(const std::filesystem::path& program,
                                      const std::vector<std::string>& arguments,
                                      std::string_view input, const WorkerLimits& limits = {});

/// Where a worker of ours lives: $CHLADNI_LIBEXEC, else beside the running binary, else the install
/// tree's libexec/chladni.
/// @throws WorkerDied  there is no such file in any of them (lists them)
[[nodiscard]] std::filesystem::path worker_path(std::string_view name);

}  // namespace chladni
