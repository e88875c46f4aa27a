// Handles Ctrl-C between two steps of work, never inside a step but for a long one.
#pragma once

#include <csignal>

namespace chladni {

/// Catches SIGINT, SIGTERM, SIGQUIT and SIGHUP from now on. A SIGHUP that is ignored, as under
/// nohup, stays ignored. The first signal is noted; where the standard error is a terminal, the
/// first Ctrl-C says so on it. A second signal ends the process at once, as its kind does by
/// default: a shell tells 130 after Ctrl-C.
void catch_interrupts();

/// For a host such as Python that has its own handler and lives on. While an object of this class
/// lives, SIGINT is only noted, also when it comes several times. Afterwards the host's handler is
/// back. If no exception was thrown for a noted signal, the host's handler gets the signal.
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

/// For a step of work that cannot ask whether a signal has come: calls of libraries that take
/// minutes and write no file. While an object of this class lives, a signal that catch_interrupts
/// notes and that nothing answers within three seconds ends the process, as a second signal does.
/// Steps in several threads may overlap. Under NotedInterrupts the signal waits for the end of the
/// step.
class LongStep {
 public:
  LongStep();
  ~LongStep();
  LongStep(const LongStep&) = delete;
  LongStep& operator=(const LongStep&) = delete;
  LongStep(LongStep&&) = delete;
  LongStep& operator=(LongStep&&) = delete;
};

/// @throws Interrupted  one of these signals has arrived
void throw_if_interrupted();

/// Whether a signal has arrived, for a step that can stop early with a partial result.
[[nodiscard]] bool interrupted();
/// Forgets a signal that was answered, so that work goes on. The next signal counts as a first one.
void forget_interrupt();

}  // namespace chladni
