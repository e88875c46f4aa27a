// The compiled part of the Python package `chladni`.
#include <dlfcn.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <filesystem>
#include <vector>

#include "base/error.h"
#include "dense/blas.h"
#include "host/descriptor.h"
#include "host/parallel.h"
#include "host/worker.h"
#include "python/calls/long_call.h"
#include "python/rooms.h"
#include "python/values/copies.h"
#include "show/version.h"

namespace chladni::python {
namespace {

namespace py = pybind11;
namespace fs = std::filesystem;

// The folder of this module and those above it: up to the prefix in which it is
// lib/python3.11/dist-packages/chladni, or to the build tree in which it is python/chladni. A wheel
// has the programs in the package itself.
std::vector<fs::path> folders_above() {
  std::vector<fs::path> folders;
  Dl_info module{};
  if (dladdr(reinterpret_cast<const void*>(&folders_above), &module) == 0) return folders;
  std::error_code fault;
  auto folder = fs::canonical(module.dli_fname, fault).parent_path();
  for (int up = 0; !fault && up < 5; ++up) {
    folders.push_back(folder);
    folder = folder.parent_path();
  }
  return folders;
}

// The arrays are NumPy's. A Python that is not from Debian may lack NumPy.
void need_numpy() {
  try {
    py::module_::import("numpy");
  } catch (const py::error_already_set& fault) {
    const auto python = py::module_::import("sys").attr("executable");
    throw py::import_error("chladni needs NumPy, which " + python.cast<std::string>() +
                           " has not (" + fault.what() + ")");
  }
}

// Turns Ctrl-C in a long call into what Python raises then, and the error of a path into ours.
void translate_others(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const Interrupted& stopped) {
    set_error_of_signal(stopped.what());
  } catch (const fs::filesystem_error& fault) {
    throw_path_error(fault);  // pybind11 asks the other translators about it
  }
}

// pybind11 tries the last registered exception first, so more special exceptions come later.
void add_exceptions(py::module_& module) {
  py::register_exception<InvalidInput>(module, "InvalidInput", PyExc_ValueError);
  const auto& failure =
      py::register_exception<NumericalFailure>(module, "NumericalFailure", PyExc_RuntimeError);
  py::register_exception<OutOfResources>(
      module, "OutOfResources",
      py::make_tuple(failure, py::reinterpret_borrow<py::object>(PyExc_MemoryError)));
  py::register_exception<WorkerDied>(module, "WorkerDied", failure);
  py::register_exception_translator(&translate_others);
  const py::exception<void> warning(module, "ChladniWarning", PyExc_UserWarning);
}

void add_machine(py::module_& module) {
  module.attr("__version__") = show::version();
  module.def("thread_count", &thread_count, "Threads of every parallel loop [physical cores].");
  module.def("set_thread_count", &set_thread_count, py::arg("count"));
  module.def("_program", [] { return program().string(); });
  module.def("blas_kernel", &dense::blas_kernel, "OpenBLAS's name of the kernel in use.");
  const auto slow = dense::slow_blas_kernel();
  if (!slow.empty() && PyErr_WarnEx(PyExc_RuntimeWarning, slow.c_str(), 1) < 0) {
    throw py::error_already_set();
  }
}

}  // namespace

fs::path program() {
  for (const auto& folder : folders_above()) {
    const auto here = folder / "bin" / "chladni";
    if (fs::exists(here)) return here;
  }
  const auto there = program_on_path("chladni");
  if (!there) {
    throw WorkerDied(
        "there is no program chladni beside the module or on the PATH; expected "
        "one, built by ./chladni or installed");
  }
  return *there;
}

}  // namespace chladni::python

PYBIND11_MODULE(_chladni, module) {
  using namespace chladni::python;
  need_numpy();
  module.doc() = "What the package chladni has in C++. All values in SI.";
  for (const auto& folder : folders_above()) {
    chladni::add_worker_folder(folder / "libexec" / "chladni");
  }
  add_exceptions(module);
  add_machine(module);
  add_studies(module);
  add_files(module);
  add_modal(module);
  add_modes(module);
  add_priors(module);
  add_placement(module);
  add_identification(module);
  add_placement_step(module);
  add_identification_step(module);
  add_diagnosis_step(module);
  add_observer_step(module);
  add_compare_step(module);
  add_experiment_step(module);
  add_sweep(module);
  add_figure(module);
  refuse_empty_objects(module);
}
