// Interpolation of shapes on arrays.
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "priors/interpolator.h"
#include "python/calls/long_call.h"
#include "python/rooms.h"
#include "python/values/given.h"

namespace chladni::python {
namespace {

namespace py = pybind11;

priors::Places places(const Given<"position", Points>& position,
                      const Given<"direction", Points>& direction,
                      const Given<"shapes", Eigen::MatrixXd>& shapes) {
  return {position.value, direction.value, shapes.value};
}

priors::Simulation simulation_with(const Given<"frequency_hz", Eigen::VectorXd>& frequency_hz,
                                   const priors::Places& surface,
                                   const Given<"area", Eigen::VectorXd>& area) {
  priors::Simulation simulation;
  simulation.frequency_hz = frequency_hz.value;
  simulation.surface = surface;
  simulation.area = area.value;
  return simulation;
}

priors::MeasuredShapes measured_with(const priors::Places& places,
                                     const Given<"frequency_hz", Eigen::VectorXd>& frequency_hz,
                                     const Given<"values", Eigen::MatrixXd>& values,
                                     const Given<"noise", Eigen::MatrixXd>& noise) {
  return {places, frequency_hz.value, values.value, noise.value};
}

void add_data(py::module_& module) {
  py::class_<priors::Places>(module, "Places", "n places with the simulation's modes there")
      .def(py::init(&places), py::arg("position"), py::arg("direction"),
           py::arg("shapes") = Eigen::MatrixXd(),
           "position n x 3 [m], direction n x 3 (unit), shapes n x r [kg^-1/2]")
      .def_readwrite("position", &priors::Places::position)
      .def_readwrite("direction", &priors::Places::direction)
      .def_readwrite("shapes", &priors::Places::shapes)
      .def("__len__", &priors::Places::count);
  py::class_<priors::Simulation>(module, "Simulation", "what the simulation says of the surface")
      .def(py::init(&simulation_with), py::arg("frequency_hz"), py::arg("surface"), py::arg("area"),
           "frequency_hz r (rigid-body modes 0), surface N places, area N [m^2]");
  py::class_<priors::MeasuredShapes>(module, "MeasuredShapes", "m shapes at s places")
      .def(py::init(&measured_with), py::arg("places"), py::arg("frequency_hz"), py::arg("values"),
           py::arg("noise"), "frequency_hz m, values s x m, noise s x m (standard deviations)");
}

}  // namespace

void add_priors(py::module_& module) {
  add_data(module);
  py::class_<priors::ModeField>(module, "ModeField", "m mode shapes with their uncertainty")
      .def(
          "at",
          [](const priors::ModeField& field, const priors::Places& places) {
            auto found = [&] {
              const LongCall call;
              return field.at(places);
            }();
            return py::make_tuple(std::move(found.mean), std::move(found.deviation));
          },
          py::arg("places"), "mean and standard deviation, each n x m")
      .def_property_readonly("notes",
                             [](const priors::ModeField& field) { return field.summary().notes; });
  module.def(
      "mode_field",
      [](const std::string& method, const priors::MeasuredShapes& measured,
         const priors::Simulation& simulation) {
        const LongCall call;
        return priors::mode_field(priors::interpolator(method), measured, simulation);
      },
      py::arg("method"), py::arg("measured"), py::arg("simulation"),
      "Fits one of interpolations() to measured shapes.");
  module.def("interpolations", [] {
    std::vector<std::string> names;
    for (const auto* one : priors::interpolators()) names.emplace_back(one->name);
    return names;
  });
}

}  // namespace chladni::python
