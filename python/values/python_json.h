// JSON as objects of Python.
#pragma once

#include <pybind11/pybind11.h>

#include "io/json.h"

namespace chladni::python {

/// null becomes None; numbers keep all their digits.
[[nodiscard]] pybind11::object python_of(const io::Json& json);

}  // namespace chladni::python
