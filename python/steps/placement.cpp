// Placement and priors of a study from Python.
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <iterator>

#include "placement/criteria.h"
#include "python/result_of_modes.h"
#include "python/rooms.h"
#include "python/values/python_json.h"
#include "show/placement.h"
#include "show/priors.h"
#include "steps/placement.h"
#include "steps/priors.h"

namespace chladni::python {
namespace {

namespace py = pybind11;

class PlacementResult : public ResultOfModes<steps::BestPlaces> {
 public:
  using ResultOfModes::ResultOfModes;
  [[nodiscard]] std::string text() const override {
    return show::placement_table(solution(), found());
  }
  [[nodiscard]] io::JsonObject json() const override {
    return show::placement_json(study(), solution(), found());
  }
  void leave(show::Run& run) const override {
    show::leave_placement(study(), solution(), found(), run, true);
  }
};

class PriorsResult : public ResultOfModes<steps::LearnedPriors> {
 public:
  using ResultOfModes::ResultOfModes;
  [[nodiscard]] std::string text() const override {
    return show::priors_table(solution(), found());
  }
  [[nodiscard]] io::JsonObject json() const override {
    return show::priors_json(solution(), found());
  }
  void leave(show::Run& run) const override { run.leave("priors.json", json(), true); }
};

std::shared_ptr<PlacementResult> place(const py::object& source, const py::object& progress,
                                       std::optional<Seed> seed) {
  return made_by<PlacementResult>(source, {progress, seed}, steps::best_places);
}

std::shared_ptr<PriorsResult> learned(const py::object& source, const py::object& progress,
                                      std::optional<Seed> seed) {
  return made_by<PriorsResult>(source, {progress, seed}, steps::learned_priors);
}

Eigen::VectorXi numbers_of_modes(const PriorsResult& result) {
  const auto& columns = result.found().columns;
  Eigen::VectorXi numbers(std::ssize(columns));
  std::transform(columns.begin(), columns.end(), numbers.begin(),
                 [](Eigen::Index column) { return static_cast<int>(column) + 1; });
  return numbers;
}

std::vector<bool> admissible(const PlacementResult& result) {
  std::vector<bool> allowed;
  for (const int rule : result.found().forbidden) allowed.push_back(rule < 0);
  return allowed;
}

py::dict maps_of(const py::object& self) {
  const auto& places = self.cast<const PlacementResult&>().found();
  py::dict maps;
  const auto criteria = placement::criteria();
  for (std::size_t c = 0; c < criteria.size(); ++c) {
    maps[py::str(std::string(criteria[c]->name))] =
        py::cast(places.maps[c].score, py::return_value_policy::reference_internal, self);
  }
  return maps;
}

py::dict deviations_of(const py::object& self) {
  py::dict deviations;
  for (const auto& layout : self.cast<const PlacementResult&>().found().layouts) {
    deviations[py::str(layout.name)] =
        py::cast(layout.deviation, py::return_value_policy::reference_internal, self);
  }
  return deviations;
}

void add_placement_result(py::module_& module) {
  using Class = py::class_<PlacementResult, std::shared_ptr<PlacementResult>, Result>;
  Class bound(module, "Placement", "Best places and layouts of a study. Arrays are views.");
  const auto view = [&bound](const char* name, auto member, const char* text) {
    bound.def_property_readonly(
        name, [member](const PlacementResult& one) -> const auto& { return member(one.found()); },
        text);
  };
  using steps::BestPlaces;
  view(
      "points", [](const BestPlaces& b) -> const auto& { return b.surface.sites.position; },
      "n x 3 [m]: places of the surface");
  view(
      "normals", [](const BestPlaces& b) -> const auto& { return b.surface.sites.normal; },
      "n x 3, outward");
  view(
      "areas", [](const BestPlaces& b) -> const auto& { return b.surface.sites.area; }, "n [m^2]");
  view(
      "triangles", [](const BestPlaces& b) -> const auto& { return b.surface.triangles; },
      "t x 3, rows of points");
  view(
      "score", [](const BestPlaces& b) -> const auto& { return b.maps[b.chosen].score; },
      "n: the heat map of the study's criterion; more is better");
  bound
      .def_property_readonly(
          "criterion",
          [](const PlacementResult& p) { return std::string(p.found().criterion->name); })
      .def_property_readonly("admissible", &admissible, "n: where a device may be")
      .def_property_readonly("maps", &maps_of, "the heat map of each criterion, n each")
      .def_property_readonly(
          "deviations", &deviations_of,
          "for each layout n: expected error of an interpolated shape, of its rms");
}

void add_priors_result(py::module_& module) {
  using Class = py::class_<PriorsResult, std::shared_ptr<PriorsResult>, Result>;
  Class(module, "Priors", "What the modes of a study teach a Gaussian process.")
      .def_property_readonly("kernel",
                             [](const PriorsResult& p) { return p.found().kernel.name(); })
      .def_property_readonly(
          "rms", [](const PriorsResult& p) -> const auto& { return p.found().rms; },
          "of each mode over the surface [kg^-1/2]")
      .def_property_readonly("modes", &numbers_of_modes,
                             "of each row, as modes.table counts them: from 1, rigid-body modes "
                             "too; a copy")
      .def_property_readonly(
          "matched_length",
          [](const PriorsResult& p) -> const auto& { return p.found().matched_length; },
          "for each mode the length of least expected error at the channels [m]; or empty");
}

}  // namespace

void add_placement_step(py::module_& module) {
  add_placement_result(module);
  add_priors_result(module);
  module.def("place", &place, py::arg("study"), py::kw_only(), py::arg("progress") = py::none(),
             py::arg("seed") = py::none(),
             "Where collocated pairs and all devices belong. study: a Study, its Modes, a file or "
             "a dict.");
  module.def("priors", &learned, py::arg("study"), py::kw_only(), py::arg("progress") = py::none(),
             py::arg("seed") = py::none(),
             "Length scales, amplitudes and noise that the modes teach.");
}

}  // namespace chladni::python
