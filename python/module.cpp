// import chladni
#include <pybind11/pybind11.h>

#include "base/error.h"
#include "python/rooms.h"

PYBIND11_MODULE(chladni, module) {
  module.doc() =
      "Modes of flexible stages, and their shapes between the sensors. All values in SI.";
  pybind11::register_exception<chladni::InvalidInput>(module, "InvalidInput", PyExc_ValueError);
  pybind11::register_exception<chladni::NumericalFailure>(module, "NumericalFailure",
                                                          PyExc_RuntimeError);
  chladni::python::add_priors(module);
  chladni::python::add_app(module);
}
