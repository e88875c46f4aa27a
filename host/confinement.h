// Takes from a worker what the reading of a file does not need: the network, other files, other
// processes. Code that a hostile file makes it run then reaches nothing.
#pragma once

#include <linux/filter.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "host/descriptor.h"

namespace chladni {

/// What the running kernel can take from a process.
struct ConfinementSupport {
  int landlock = 0;         ///< version of Landlock, which limits files; 0: there is none
  bool has_filter = false;  ///< seccomp, which limits calls of the system
  std::string text()
      const;  ///< "no network, no processes, no files but theirs", or what is missing
};

/// Sanitizers call what a filter forbids: their builds have neither.
[[nodiscard]] ConfinementSupport confinement_support();

/// The limits of one worker, prepared before it is forked.
///
/// It may read the files of the system's programs and libraries (/usr, /lib, /bin), the folders of
/// its program and of LD_LIBRARY_PATH, what states processors and memory, and `files`. It inherits
/// its three pipes and no other descriptor, and writes to them alone. An attempt to open a socket
/// other than a local one, to start or signal another process, to have signals sent by its pipes,
/// or to change the state of the system ends it with SIGSYS; limits and schedulers of others are
/// refused; an attempt on a file or a local socket fails with EACCES. It has at most
/// `processor_time`, 64 open files, and no file grows by it. Threads are allowed, so there is no
/// RLIMIT_NPROC, which counts them. All holds for threads that a library starts as it is loaded, as
/// OpenBLAS does.
class Confinement {
 public:
  Confinement(const std::filesystem::path& program, const std::vector<std::filesystem::path>& files,
              std::chrono::seconds processor_time);

  /// Confines the calling process, for ever. Only calls that are safe between fork and exec.
  /// @return  whether everything that the kernel supports holds; errno says why not
  [[nodiscard]] bool apply() noexcept;

 private:
  std::chrono::seconds processor_time_;
  Descriptor files_;                 // Landlock's rules, if any
  std::vector<sock_filter> filter_;  // empty: none
};

}  // namespace chladni
