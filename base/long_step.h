// A step of work that cannot ask whether a signal has come.
#pragma once

namespace chladni {

/// While an object of this class lives, a signal that catch_interrupts notes and that nothing
/// answers within three seconds ends the process, as a second signal does. For calls of libraries
/// that take minutes and write no file. Steps in several threads may overlap. Where a host has a
/// handler of its own (NotedInterrupts), the signal waits for the end of the step.
class LongStep {
 public:
  LongStep();
  ~LongStep();
  LongStep(const LongStep&) = delete;
  LongStep& operator=(const LongStep&) = delete;
  LongStep(LongStep&&) = delete;
  LongStep& operator=(LongStep&&) = delete;
};

}  // namespace chladni
