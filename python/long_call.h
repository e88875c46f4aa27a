// Long calls from Python.
#pragma once

#include <pybind11/pybind11.h>

#include <optional>

#include "base/interrupt.h"

namespace chladni::python {

/// While it lives, other threads of Python run, and Ctrl-C stops the work as it does on the command
/// line; the call then raises KeyboardInterrupt. Python hears signals in its main thread alone, so
/// a call from another one cannot be stopped. Nothing of Python may be touched meanwhile.
class LongCall {
 public:
  LongCall() {
    const auto threading = pybind11::module_::import("threading");
    if (threading.attr("current_thread")().is(threading.attr("main_thread")())) noted_.emplace();
    released_.emplace();
  }

 private:
  std::optional<NotedInterrupts> noted_;
  std::optional<pybind11::gil_scoped_release> released_;  // taken back before the handler
};

}  // namespace chladni::python
