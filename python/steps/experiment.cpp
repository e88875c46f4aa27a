// The designed experiment of a study from Python.
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "base/error.h"
#include "io/time_file.h"
#include "python/result_of_modes.h"
#include "python/rooms.h"
#include "show/experiment.h"
#include "steps/designed.h"

namespace chladni::python {
namespace {

namespace py = pybind11;

class DesignedResult : public ResultOfModes<steps::DesignedExperiment> {
 public:
  using ResultOfModes::ResultOfModes;
  [[nodiscard]] std::string text() const override {
    return show::experiment_text(study(), found());
  }
  [[nodiscard]] io::JsonObject json() const override {
    return show::experiment_json(study(), found());
  }
  void leave(show::Run& run) const override { show::leave_experiment(study(), found(), run); }
};

std::shared_ptr<DesignedResult> design_experiment(const py::object& source,
                                                  const py::object& progress,
                                                  std::optional<Seed> seed) {
  return made_by<DesignedResult>(source, {progress, seed}, steps::designed, steps::require_design);
}

py::object excitation_in(const DesignedResult& one) {
  const auto& design = one.found().multisine;
  if (!design) return py::none();
  return py::cast(std::make_shared<io::TimeFile>(
      io::TimeFile{"designed experiment", steps::excitation_of(one.study(), *design), {}}));
}

Eigen::MatrixXd sequence_in(const DesignedResult& one, int realisation, int experiment) {
  const auto& design = one.found().multisine;
  require(design.has_value(), "a hammer test plays no signals; its blows are at points");
  require(realisation >= 0 && experiment >= 0,
          "realisation and experiment are counted from 0; a negative number was given");
  return steps::sequence_of(one.study(), *design, static_cast<std::size_t>(realisation),
                            static_cast<std::size_t>(experiment));
}

}  // namespace

void add_experiment_step(py::module_& module) {
  using Class = py::class_<DesignedResult, std::shared_ptr<DesignedResult>, Result>;
  Class(module, "DesignedExperiment",
        "Signals to play or points to hit, and what they will tell. Arrays are copies, but points "
        "and normals.")
      .def_property_readonly(
          "duration_s", [](const DesignedResult& d) { return d.found().duration_s(); },
          "of the whole measurement")
      .def_property_readonly("excitation", &excitation_in,
                             "Recordings whose inputs are one period of each experiment and "
                             "realisation, as commands; None with a hammer")
      .def_property_readonly(
          "unit", [](const DesignedResult& d) { return steps::command_unit(d.study()); },
          "of the commands: \"N\", or \"V\" where the study has design.force_per_volt")
      .def_property_readonly(
          "line_hz",
          [](const DesignedResult& d) {
            return d.found().multisine ? d.found().multisine->line_hz : Eigen::VectorXd();
          },
          "excited lines; empty with a hammer")
      .def_property_readonly(
          "amplitude",
          [](const DesignedResult& d) {
            return d.found().multisine ? d.found().multisine->amplitude : Eigen::MatrixXd();
          },
          "lines x actuators [N]: of the sine on each line")
      .def_property_readonly(
          "points",
          [](const DesignedResult& d) -> const auto& { return d.found().points.position; },
          "of the blows: n x 3 [m], the most useful first; empty without a hammer")
      .def_property_readonly(
          "normals", [](const DesignedResult& d) -> const auto& { return d.found().points.normal; },
          "n x 3, outward, of the body at the points")
      .def("sequence", &sequence_in, py::arg("realisation") = 0, py::arg("experiment") = 0,
           "All that is played in one experiment: samples x actuators, as commands, with settling, "
           "recorded periods and fades.");
  module.def("experiment", &design_experiment, py::arg("study"), py::kw_only(),
             py::arg("progress") = py::none(), py::arg("seed") = py::none(),
             "What to play or where to hit, and what it will tell. study with [design].");
}

}  // namespace chladni::python
