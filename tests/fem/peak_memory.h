// The peak of a process of its own, from what it held before, against what was forecast.
#pragma once

#include <malloc.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <string>

namespace chladni::fem {

struct Peak {
  double forecast = 0.0, used = 0.0;  // bytes
};

inline double memory_status(const char* key) {
  std::ifstream in("/proc/self/status");
  for (std::string word; in >> word;) {
    double kib = 0.0;
    if (word == key && in >> kib) return 1024.0 * kib;
  }
  return 0.0;
}

/// @param work  returns its forecast [bytes]
template <typename Work>
Peak peak_of(Work work) {
  std::array<int, 2> pipe_ends{};
  if (pipe(pipe_ends.data()) != 0) return {};
  malloc_trim(0);  // what was freed before would serve the work unseen
  const pid_t child = fork();
  if (child == 0) {
    std::ofstream("/proc/self/clear_refs") << "5";  // the peak counts from here
    Peak peak;
    const double before = memory_status("VmRSS:");
    peak.forecast = work();
    peak.used = memory_status("VmHWM:") - before;
    _exit(write(pipe_ends[1], &peak, sizeof peak) == ssize_t{sizeof peak} ? 0 : 1);
  }
  close(pipe_ends[1]);  // a child that dies ends the pipe
  Peak peak;
  const auto got = read(pipe_ends[0], &peak, sizeof peak);
  int ended = 0;
  waitpid(child, &ended, 0);
  close(pipe_ends[0]);
  return got == ssize_t{sizeof peak} && ended == 0 ? peak : Peak{};
}

}  // namespace chladni::fem
