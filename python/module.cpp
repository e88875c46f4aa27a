// The Python module `chladni`.
#include <dlfcn.h>
#include <pybind11/pybind11.h>

#include <filesystem>

#include "base/error.h"
#include "base/worker.h"
#include "dense/blas.h"
#include "python/rooms.h"
#include "show/version.h"

namespace {

// Adds the folders of our workers, which are not beside the Python program. The workers are in the
// prefix of this module, three folders up from lib/python3.11/dist-packages, or in the module's
// build tree, one folder up from python/.
void find_workers() {
  Dl_info module{};
  if (dladdr(reinterpret_cast<const void*>(&find_workers), &module) == 0) return;
  std::error_code fault;
  auto folder = std::filesystem::canonical(module.dli_fname, fault).parent_path();
  for (int up = 0; !fault && up < 3; ++up) {
    folder = folder.parent_path();
    chladni::add_worker_folder(folder / "libexec" / "chladni");
  }
}

// The arrays are NumPy's. A Python that is not from Debian may lack NumPy.
void need_numpy() {
  try {
    pybind11::module_::import("numpy");
  } catch (const pybind11::error_already_set& fault) {
    const auto python = pybind11::module_::import("sys").attr("executable");
    throw pybind11::import_error("chladni needs NumPy, which " + python.cast<std::string>() +
                                 " has not (" + fault.what() + ")");
  }
}

// Turns Ctrl-C in a long call into Python's KeyboardInterrupt.
void translate_interrupts(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const chladni::Interrupted& stopped) {
    PyErr_SetString(PyExc_KeyboardInterrupt, stopped.what());
  }
}

}  // namespace

PYBIND11_MODULE(chladni, module) {
  need_numpy();
  module.doc() =
      "Modes of flexible stages, and their shapes between the sensors. All values in SI.";
  module.attr("__version__") = chladni::show::version();
  find_workers();
  // pybind11 tries the last registered exception first, so more special exceptions come later.
  pybind11::register_exception<chladni::InvalidInput>(module, "InvalidInput", PyExc_ValueError);
  const auto& failure = pybind11::register_exception<chladni::NumericalFailure>(
      module, "NumericalFailure", PyExc_RuntimeError);
  pybind11::register_exception<chladni::OutOfResources>(module, "OutOfResources", failure);
  pybind11::register_exception<chladni::WorkerDied>(module, "WorkerDied", failure);
  pybind11::register_exception_translator(&translate_interrupts);
  const auto slow = chladni::dense::slow_blas_kernel();
  if (!slow.empty() && PyErr_WarnEx(PyExc_RuntimeWarning, slow.c_str(), 1) < 0) {
    throw pybind11::error_already_set();
  }
  chladni::python::add_priors(module);
  chladni::python::add_placement(module);
  chladni::python::add_identification(module);
  chladni::python::add_app(module);
}
