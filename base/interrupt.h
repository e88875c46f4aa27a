// Ctrl-C, answered between two steps of work and never inside one.
#pragma once

#include <csignal>

namespace chladni {

/// Catches SIGINT, SIGTERM, SIGQUIT and SIGHUP (unless it is ignored, as under nohup) from now on;
/// the first one is noted, a second one ends the process.
void catch_interrupts();

/// For a host, such as Python, that has a handler of its own and lives on: SIGINT is noted while
/// this lives, however often it comes, and the host's handler is back afterwards. It gets a signal
/// that nothing was thrown for.
class NotedInterrupts {
 public:
  NotedInterrupts();
  ~NotedInterrupts();
  NotedInterrupts(const NotedInterrupts&) = delete;
  NotedInterrupts& operator=(const NotedInterrupts&) = delete;
  NotedInterrupts(NotedInterrupts&&) = delete;
  NotedInterrupts& operator=(NotedInterrupts&&) = delete;

 private:
  struct sigaction before_ = {};
};

/// @throws Interrupted  one of these signals has arrived since
void throw_if_interrupted();

/// Whether one has arrived, for a step that can stop with what it has.
[[nodiscard]] bool interrupted();
/// It was answered: work goes on. The next one ends the process as a first one would.
void forget_interrupt();

}  // namespace chladni
