// The functions that add each room to the module.
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>

namespace chladni::python {

void add_studies(pybind11::module_& module);
void add_modal(pybind11::module_& module);
void add_modes(pybind11::module_& module);
void add_priors(pybind11::module_& module);
void add_placement(pybind11::module_& module);
void add_identification(pybind11::module_& module);
void add_files(pybind11::module_& module);
void add_placement_step(pybind11::module_& module);
void add_identification_step(pybind11::module_& module);
void add_diagnosis_step(pybind11::module_& module);
void add_observer_step(pybind11::module_& module);
void add_compare_step(pybind11::module_& module);
void add_experiment_step(pybind11::module_& module);
void add_sweep(pybind11::module_& module);
void add_figure(pybind11::module_& module);

/// The program chladni of this module's build tree or prefix, or else on the PATH.
/// @throws WorkerDied  there is none
[[nodiscard]] std::filesystem::path program();

}  // namespace chladni::python
