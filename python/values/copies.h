// What objects of plain data are copied and pickled by: a tuple that makes an equal one again.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>

#include "io/frf_file.h"
#include "modal/control_model.h"

namespace chladni::python {

[[nodiscard]] pybind11::tuple state_of(const modal::MeasuredChannel& channel);
[[nodiscard]] pybind11::tuple state_of(const io::FrfFile& file);
[[nodiscard]] pybind11::tuple state_of(const modal::ControlModel& model);

/// @throws InvalidInput, pybind11::cast_error  a tuple that state_of did not make
[[nodiscard]] modal::MeasuredChannel channel_of(const pybind11::tuple& state);
[[nodiscard]] std::shared_ptr<io::FrfFile> frf_of(const pybind11::tuple& state);
[[nodiscard]] modal::ControlModel control_model_of(const pybind11::tuple& state);

/// Classes of the module make their objects alone: __new__ would give one that holds nothing, and
/// what reads it would crash.
void refuse_empty_objects(const pybind11::module_& module);

}  // namespace chladni::python
