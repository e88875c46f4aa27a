// Long calls from Python.
#pragma once

#include <pybind11/pybind11.h>

#include <optional>

#include "base/interrupt.h"

namespace chladni::python {

/// While an object of this class lives, other Python threads run, and Ctrl-C stops the work as on
/// the command line; the call then raises KeyboardInterrupt. Python handles signals only in its
/// main thread, so a call from another thread cannot be stopped. Code must not use Python objects
/// meanwhile.
class LongCall {
 public:
  LongCall() {
    const auto threading = pybind11::module_::import("threading");
    if (threading.attr("current_thread")().is(threading.attr("main_thread")())) noted_.emplace();
    released_.emplace();
  }

 private:
  std::optional<NotedInterrupts> noted_;
  std::optional<pybind11::gil_scoped_release> released_;  // ends before noted_ does
};

}  // namespace chladni::python
