#include "python/calls/python_work.h"

#include <pybind11/stl.h>

#include "host/memory.h"

namespace chladni::python {
namespace {

namespace py = pybind11;

stage::WorkOptions options_of(const Subject& subject, const Asked& asked) {
  stage::WorkOptions options;
  options.seed = asked.seed.value_or(Seed{subject.study().seed.value_or(1)}).value;
  options.certificate = asked.certificate;
  options.engine = asked.engine;
  options.memory_limit_bytes = bytes_of_gigabytes(asked.memory_limit_gb);
  options.allowed = subject.opened->allowed;
  // Paths of an extended study start where those of the study do.
  options.folder = std::filesystem::absolute(subject.study().file).parent_path();
  return options;
}

py::object listener_of(const Asked& asked) {
  return py::module_::import("chladni._progress").attr("listener")(asked.progress);
}

}  // namespace

PythonWork::PythonWork(const Subject& subject, const Asked& asked)
    : stage::Work(options_of(subject, asked)), heard_(listener_of(asked)) {}

PythonWork::PythonWork(const Asked& asked) : heard_(listener_of(asked)) {}

PythonWork::~PythonWork() {
  try {
    if (py::hasattr(heard_, "close")) heard_.attr("close")();
  } catch (const py::error_already_set&) {
    return;  // a bar that cannot be cleared is no failure of the step
  }
}

Progress PythonWork::progress() {
  if (heard_.is_none()) return {};
  return [this](std::string_view step, double fraction) { hear(step, fraction); };
}

void PythonWork::hear(std::string_view step, double fraction) {
  using namespace std::chrono_literals;
  const auto now = std::chrono::steady_clock::now();
  const bool is_end = fraction >= 1.0;  // whoever counts on it waits for it
  if (step == last_step_ && !is_end && now - last_time_ < 100ms) return;
  last_step_ = step;
  last_time_ = now;
  const py::gil_scoped_acquire lock;
  try {
    heard_(last_step_, fraction < 0.0 ? py::object(py::none()) : py::float_(fraction));
  } catch (py::error_already_set& fault) {
    raised_.emplace(std::move(fault));
    throw Interrupted("the function that is told of the progress raised an exception");
  }
}

Said PythonWork::said() {
  Said said = said_;
  said.seconds = seconds();
  said.seed = seed();
  warn_python(said.warnings);
  return said;
}

void warn_python(const std::vector<std::string>& warnings) {
  if (!warnings.empty()) py::module_::import("chladni._progress").attr("warn")(warnings);
}

}  // namespace chladni::python
