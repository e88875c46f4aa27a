#include "python/calls/long_call.h"

#include <csignal>
#include <utility>

namespace chladni::python {
namespace {

namespace py = pybind11;

// What the user's handler raised in a long call of this thread, until the call raises it.
thread_local std::optional<py::error_already_set> raised_by_handler;

// Calls the user's handler as Python does. Whether it raised something.
bool handler_raised() {
  const py::gil_scoped_acquire lock;
  PyErr_SetInterrupt();
  if (PyErr_CheckSignals() == 0) return false;
  raised_by_handler.emplace();  // takes the error of Python
  return true;
}

bool is_main_thread() {
  const auto threading = py::module_::import("threading");
  return threading.attr("current_thread")().is(threading.attr("main_thread")());
}

}  // namespace

LongCall::LongCall() {
  raised_by_handler.reset();
  if (is_main_thread()) {
    const auto signals = py::module_::import("signal");
    const py::object handler = signals.attr("getsignal")(SIGINT);
    const bool is_own = !handler.is_none() && !handler.is(signals.attr("default_int_handler"));
    const bool is_left_alone =
        handler.is(signals.attr("SIG_IGN")) || handler.is(signals.attr("SIG_DFL"));
    if (!is_own) {
      noted_.emplace();
    } else if (!is_left_alone) {
      answered_.emplace(&handler_raised);
    }
  }
  released_.emplace();
}

void set_error_of_signal(const char* words) {
  if (!raised_by_handler) return PyErr_SetString(PyExc_KeyboardInterrupt, words);
  auto raised = std::exchange(raised_by_handler, std::nullopt);
  raised->restore();
}

}  // namespace chladni::python
