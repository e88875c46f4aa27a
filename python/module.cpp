// import chladni
#include <pybind11/pybind11.h>

#include "base/error.h"
#include "fem/blas.h"
#include "python/rooms.h"

PYBIND11_MODULE(chladni, module) {
  module.doc() =
      "Modes of flexible stages, and their shapes between the sensors. All values in SI.";
  pybind11::register_exception<chladni::InvalidInput>(module, "InvalidInput", PyExc_ValueError);
  pybind11::register_exception<chladni::NumericalFailure>(module, "NumericalFailure",
                                                          PyExc_RuntimeError);
  pybind11::register_exception<chladni::Interrupted>(module, "Interrupted",
                                                     PyExc_KeyboardInterrupt);
  const auto slow = chladni::fem::slow_blas_kernel();
  if (!slow.empty() && PyErr_WarnEx(PyExc_RuntimeWarning, slow.c_str(), 1) < 0) {
    throw pybind11::error_already_set();
  }
  chladni::python::add_priors(module);
  chladni::python::add_app(module);
}
