// The functions that add each room to the module.
#pragma once

#include <pybind11/pybind11.h>

namespace chladni::python {

void add_priors(pybind11::module_& module);
void add_placement(pybind11::module_& module);
void add_identification(pybind11::module_& module);
void add_app(pybind11::module_& module);

}  // namespace chladni::python
