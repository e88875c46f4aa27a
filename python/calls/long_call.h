// Long calls from Python.
#pragma once

#include <pybind11/pybind11.h>

#include <optional>

#include "base/answered_interrupts.h"
#include "base/interrupt.h"

namespace chladni::python {

/// While an object of this class lives, other Python threads run, and Ctrl-C stops the work as on
/// the command line; the call then raises KeyboardInterrupt. A handler that the user has set is
/// called instead, between two steps of the work: what it raises ends the call, else the work goes
/// on. Where SIGINT is ignored or has its default action it is left alone. Python handles signals
/// only in its main thread, so a call from another thread cannot be stopped. Code must not use
/// Python objects meanwhile.
class LongCall {
 public:
  LongCall();

 private:
  std::optional<NotedInterrupts> noted_;
  std::optional<AnsweredInterrupts> answered_;
  std::optional<pybind11::gil_scoped_release> released_;  // ends before the others do
};

/// Sets the error of Python for work that a signal has stopped: what the user's handler raised in
/// this thread, or KeyboardInterrupt with these words.
void set_error_of_signal(const char* words);

}  // namespace chladni::python
