// Responses at any place of a structure, from arrays of measured responses.
#include <fmt/format.h>

#include <pybind11/complex.h>
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <complex>
#include <optional>
#include <utility>

#include "base/error.h"
#include "identification/response_field.h"
#include "python/calls/long_call.h"
#include "python/rooms.h"
#include "python/values/frf_arrays.h"
#include "python/values/given.h"

namespace chladni::python {
namespace {

namespace py = pybind11;

std::vector<modal::MeasuredChannel> channels_at(const priors::Places& places,
                                                const std::string& letter) {
  std::vector<modal::MeasuredChannel> channels;
  for (Eigen::Index i = 0; i < places.count(); ++i) {
    modal::MeasuredChannel channel;
    channel.name = letter + fmt::to_string(i + 1);
    channel.position = places.position.row(i).transpose();
    channel.direction = places.direction.row(i).transpose();
    channels.push_back(std::move(channel));
  }
  return channels;
}

using Lines = Given<"frequency_hz", Eigen::VectorXd>;
using Variance = std::optional<Given<"variance", Numbers>>;

modal::FrfSet frf_set(const Lines& frequency_hz, const py::object& responses,
                      const priors::Places& outputs, const priors::Places& inputs,
                      const Variance& variance) {
  const auto value = array_in<Complexes>(responses, "responses");
  modal::FrfSet set;
  set.outputs = channels_at(outputs, "output ");
  set.inputs = channels_at(inputs, "input ");
  set.frequency_hz = frequency_hz.value;
  set.value = matrices_of<Eigen::MatrixXcd>(value, "responses", outputs.count(), inputs.count());
  if (variance) {
    set.variance =
        matrices_of<Eigen::MatrixXd>(variance->value, "variance", outputs.count(), inputs.count());
  }
  modal::check(set);
  require_phase(responses, "responses");
  return set;
}

py::tuple responses_at(const identification::ResponseField& field, const priors::Places& places,
                       const Lines& frequency_hz) {
  require_frequencies(frequency_hz.value);
  const auto found = [&] {
    const LongCall call;
    return field.at(places, frequency_hz.value);
  }();
  const auto inputs = field.fit().model.input_count();
  return py::make_tuple(array_of<Complexes>(found.value, places.count(), inputs),
                        array_of<Numbers>(found.deviation, places.count(), inputs));
}

}  // namespace

void add_identification(py::module_& module) {
  using identification::ResponseField;
  py::class_<ResponseField>(module, "ResponseField", "responses at any place of a structure")
      .def("at", &responses_at, py::arg("places"), py::arg("frequency_hz"),
           "value and standard deviation, each lines x places x inputs [m/N]")
      .def_property_readonly(
          "frequency_hz", [](const ResponseField& field) { return field.fit().model.frequency_hz; },
          "of the identified modes")
      .def_property_readonly("damping_ratio", [](const ResponseField& field) {
        return field.fit().model.damping_ratio;
      });
  module.def(
      "response_field",
      [](const Lines& frequency_hz, const py::object& responses, const priors::Places& outputs,
         const priors::Places& inputs, const priors::Simulation& simulation,
         const Variance& variance, int rigid_body_modes, const std::string& method) {
        const auto set = frf_set(frequency_hz, responses, outputs, inputs, variance);
        identification::ResponseFieldPlan plan;
        plan.fit.rigid_count = rigid_body_modes;
        plan.method = method;
        const LongCall call;
        return identification::response_field(set, simulation, outputs, inputs, plan);
      },
      py::arg("frequency_hz"), py::arg("responses"), py::arg("outputs"), py::arg("inputs"),
      py::arg("simulation"), py::arg("variance") = py::none(), py::arg("rigid_body_modes") = 0,
      py::arg("method") = "dynamic_residual",
      "G between the sensors. frequency_hz lines; responses lines x outputs x inputs [m/N], nan "
      "where nothing was measured; outputs and inputs Places with the simulation's modes; variance "
      "as responses [m^2/N^2]; rigid_body_modes at 0 Hz, -1: found.");
}

}  // namespace chladni::python
