// State spaces and the similarity of shapes from Python.
#include <pybind11/complex.h>
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>
#include <vector>

#include "base/interrupt.h"
#include "modal/control_model.h"
#include "modal/mac.h"
#include "python/calls/long_call.h"
#include "python/rooms.h"
#include "python/values/copies.h"
#include "python/values/frf_arrays.h"
#include "python/values/given.h"

namespace chladni::python {
namespace {

namespace py = pybind11;

std::vector<std::string> names_in(const std::vector<modal::Signal>& signals) {
  std::vector<std::string> names;
  for (const auto& one : signals) names.push_back(one.name);
  return names;
}

std::vector<std::string> units_in(const std::vector<modal::Signal>& signals) {
  std::vector<std::string> units;
  for (const auto& one : signals) units.push_back(one.unit);
  return units;
}

Complexes responses_on(const modal::ControlModel& model,
                       const Given<"frequency_hz", Eigen::VectorXd>& frequency_hz) {
  require_frequencies(frequency_hz.value);
  std::vector<Eigen::MatrixXcd> values;
  {
    const LongCall call;
    for (const double f : frequency_hz.value) {
      throw_if_interrupted();
      values.push_back(modal::response(model, f));
    }
  }
  return array_of<Complexes>(values, model.space.c.rows(), model.space.b.cols());
}

template <typename Matrix>
Eigen::MatrixXd mac_in(const py::object& a, const py::object& b) {
  const auto of_a = array_in<Matrix>(a, "a");
  const auto of_b = array_in<Matrix>(b, "b");
  const LongCall call;
  return modal::mac(of_a, of_b);
}

// Products of real shapes cost a quarter of those of complex ones.
Eigen::MatrixXd mac_of(const py::object& a, const py::object& b) {
  return is_complex(a) || is_complex(b) ? mac_in<Eigen::MatrixXcd>(a, b)
                                        : mac_in<Eigen::MatrixXd>(a, b);
}

void add_state_space(py::module_& module) {
  using modal::ControlModel;
  py::class_<ControlModel>(module, "StateSpace",
                           "y = C x + D u with a delay of each channel. Arrays are views.")
      .def_property_readonly(
          "A", [](const ControlModel& m) -> const auto& { return m.space.a; })
      .def_property_readonly(
          "B", [](const ControlModel& m) -> const auto& { return m.space.b; })
      .def_property_readonly(
          "C", [](const ControlModel& m) -> const auto& { return m.space.c; })
      .def_property_readonly(
          "D", [](const ControlModel& m) -> const auto& { return m.space.d; })
      .def_property_readonly(
          "sample_time_s", [](const ControlModel& m) { return m.space.sample_time_s; },
          "0: continuous")
      .def_property_readonly("states", [](const ControlModel& m) { return names_in(m.states); })
      .def_property_readonly("inputs", [](const ControlModel& m) { return names_in(m.inputs); })
      .def_property_readonly("outputs", [](const ControlModel& m) { return names_in(m.outputs); })
      .def_property_readonly("state_units",
                             [](const ControlModel& m) { return units_in(m.states); })
      .def_property_readonly("input_units",
                             [](const ControlModel& m) { return units_in(m.inputs); })
      .def_property_readonly("output_units",
                             [](const ControlModel& m) { return units_in(m.outputs); })
      .def_property_readonly(
          "input_delay", [](const ControlModel& m) -> const auto& { return m.input_delay; },
          "[s], or samples of a discrete model")
      .def_property_readonly(
          "output_delay", [](const ControlModel& m) -> const auto& { return m.output_delay; },
          "[s], or samples of a discrete model")
      .def("frf", &responses_on, py::arg("frequency_hz"),
           "lines x outputs x inputs, delays included")
      .def("_state", [](const ControlModel& model) { return state_of(model); })
      .def_static("_of_state", &control_model_of)
      .def("with_delay_states", &modal::with_delay_states,
           "The delays of a discrete model as states.");
}

}  // namespace

void add_modal(py::module_& module) {
  add_state_space(module);
  module.def("mac", &mac_of, py::arg("a"), py::arg("b"),
             "Modal assurance criterion of the columns of a and b, real or complex; in [0, 1].");
}

}  // namespace chladni::python
