// Best places and layouts on arrays.
#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cmath>
#include <optional>

#include "base/error.h"
#include "placement/best_layouts.h"
#include "placement/best_pairs.h"
#include "python/long_call.h"
#include "python/rooms.h"

namespace chladni::python {
namespace {

namespace py = pybind11;
using placement::Plan;

// Sites of arrays; without slopes they say nothing of an error of the position.
struct ArraySites : placement::Sites {
  bool has_slopes = true;
};

void require_slopes(const ArraySites& sites, const Plan& plan) {
  require(sites.has_slopes || plan.position_error == 0.0,
          fmt::format("plan.position_error is {:g} m and the Sites have no slopes, from which its "
                      "effect follows; expected Sites(..., slopes) or position_error = 0",
                      plan.position_error));
}

ArraySites surface_sites(const Points& position, const Eigen::VectorXd& area,
                         const Eigen::MatrixXd& shapes,
                         const std::optional<Eigen::MatrixXd>& slopes) {
  ArraySites sites;
  sites.position = position;
  sites.normal = Points::Zero(position.rows(), 3);
  sites.patch = Eigen::VectorXi::Zero(position.rows());
  sites.area = area;
  sites.shapes = shapes;
  sites.has_slopes = slopes.has_value();
  sites.slopes = slopes.value_or(Eigen::MatrixXd::Zero(shapes.rows(), shapes.cols()));
  sites.whole.assign(static_cast<std::size_t>(position.rows()), 1);
  return sites;
}

placement::Channels channel_rows(const Points& position, const Points& direction,
                                 const Eigen::MatrixXd& shapes, const std::vector<bool>& stays) {
  placement::Channels channels{{position, direction}, shapes, {}};
  for (const bool stay : stays) channels.stays.push_back(stay ? 1 : 0);
  return channels;
}

placement::Structure structure_with(const Eigen::VectorXd& frequency_hz, double mass_kg,
                                    double size, const std::optional<Eigen::VectorXd>& damping,
                                    const placement::Channels& sensors,
                                    const placement::Channels& actuators) {
  placement::Structure structure;
  structure.frequency_hz = frequency_hz;
  structure.damping_ratio = damping.value_or(Eigen::VectorXd::Zero(frequency_hz.size()));
  structure.rigid_count = (frequency_hz.array() == 0.0).count();
  structure.mass_kg = mass_kg;
  structure.size = size;
  structure.sensors = sensors;
  structure.actuators = actuators;
  return structure;
}

placement::WantedModes wanted(const placement::Structure& structure, const ArraySites& surface,
                              const Plan& plan) {
  std::vector<std::string> notes;
  return placement::wanted_modes(structure, surface, plan, notes);
}

std::vector<placement::BestPair> best_pairs(const placement::Structure& structure,
                                            const ArraySites& surface, const Plan& plan) {
  require_slopes(surface, plan);
  const LongCall call;
  const placement::PairViews views(structure, surface, wanted(structure, surface, plan), plan);
  const auto places = placement::best_pairs(views, surface, {surface, true}, plan, nullptr, {});
  return plan.pairs > 1 ? places.pairs : places.best;
}

std::vector<placement::Optimum> best_layouts(const placement::Structure& structure,
                                             const ArraySites& surface, const Plan& plan,
                                             unsigned seed) {
  const LongCall call;
  return placement::best_layouts(structure, surface, {surface, true},
                                 wanted(structure, surface, plan), plan, seed);
}

py::dict layout_score(const placement::Structure& structure, const ArraySites& surface,
                      const Plan& plan, const std::vector<std::size_t>& sensors,
                      const std::vector<std::size_t>& actuators) {
  require_slopes(surface, plan);
  const auto score = [&] {
    const LongCall call;
    return placement::LayoutScorer(structure, surface, wanted(structure, surface, plan), plan)
        .of_channels(sensors, actuators);
  }();
  py::dict scores;
  const auto criteria = placement::layout_criteria();
  for (std::size_t c = 0; c < criteria.size(); ++c) {
    scores[py::str(std::string(criteria[c]->name))] = score.scores(static_cast<Eigen::Index>(c));
  }
  py::dict result;
  result["scores"] = scores;
  result["blind_modes"] = score.blind;
  result["collocated_pairs"] = score.pairs;
  result["deviation"] = score.deviation;
  return result;
}

void add_structure(py::module_& module) {
  py::class_<ArraySites>(module, "Sites", "n places where devices may be, with r modes")
      .def(py::init(&surface_sites), py::arg("position"), py::arg("area"), py::arg("shapes"),
           py::arg("slopes") = py::none(),
           "position n x 3 [m], area n [m^2], shapes n x r [kg^-1/2], slopes n x r "
           "[kg^-1/2 m^-1] along the surface (none: not known, for a position_error of 0)")
      .def("__len__", [](const ArraySites& sites) { return sites.count(); });
  py::class_<placement::Channels>(module, "Channels", "s sensors, or s actuators")
      .def(py::init<>())
      .def(py::init(&channel_rows), py::arg("position"), py::arg("direction"), py::arg("shapes"),
           py::arg("stays") = std::vector<bool>{},
           "position s x 3 [m], direction s x 3 (unit), shapes s x r [kg^-1/2]; stays s: true "
           "where a channel keeps its place")
      .def("__len__", &placement::Channels::count);
  py::class_<placement::Structure>(module, "Structure", "a structure with r modes")
      .def(py::init(&structure_with), py::arg("frequency_hz"), py::arg("mass_kg"), py::arg("size"),
           py::arg("damping_ratio") = py::none(), py::arg("sensors") = placement::Channels{},
           py::arg("actuators") = placement::Channels{},
           "frequency_hz r, rigid-body modes first with 0 Hz; size: the diagonal of its box [m]");
}

void add_plan(py::module_& module) {
  py::class_<Plan>(module, "PlacementPlan", "what a placement is for")
      .def(py::init<>())
      .def_readwrite("modes", &Plan::modes, "flexible modes, counted from 1; empty: three")
      .def_readwrite("up_to_hz", &Plan::up_to_hz, "all flexible modes below it, instead of modes")
      .def_readwrite("criterion", &Plan::criterion)
      .def_readwrite("frequency_tolerance", &Plan::frequency_tolerance)
      .def_readwrite("noise", &Plan::noise, "of a shape's entry, over the shape's rms")
      .def_readwrite("position_error", &Plan::position_error, "[m]")
      .def_readwrite("spacing", &Plan::spacing, "[m], least distance between two devices")
      .def_readwrite("pairs", &Plan::pairs, "to choose together")
      .def_readwrite("sites", &Plan::sites, "of a best layout; 0: one more than the modes")
      .def_readwrite("by_interpolation", &Plan::by_interpolation);
}

void add_results(py::module_& module) {
  py::class_<placement::BestPair>(module, "BestPair", "a place of a collocated pair")
      .def_readonly("position", &placement::BestPair::position, "[m]")
      .def_readonly("score", &placement::BestPair::score)
      .def_readonly("limiting", &placement::BestPair::limiting,
                    "index of the group of wanted modes that limits the score");
  py::class_<placement::Optimum>(module, "BestLayout", "a best layout of sensors")
      .def_readonly("by", &placement::Optimum::by)
      .def_property_readonly("rows",
                             [](const placement::Optimum& optimum) { return optimum.choice.sites; })
      .def_property_readonly("score",
                             [](const placement::Optimum& optimum) { return optimum.choice.score; })
      .def_readonly("sites", &placement::Optimum::sites, "count x 3 [m]")
      .def_readonly("certificate", &placement::Optimum::certificate, "proven D-efficiency; 0: none")
      .def_readonly("remark", &placement::Optimum::remark);
}

}  // namespace

void add_placement(py::module_& module) {
  add_structure(module);
  add_plan(module);
  add_results(module);
  module.def("best_pairs", &best_pairs, py::arg("structure"), py::arg("sites"), py::arg("plan"),
             "The best places of a collocated pair, best first; with plan.pairs > 1 the pairs that "
             "are chosen together.");
  module.def("best_layouts", &best_layouts, py::arg("structure"), py::arg("sites"), py::arg("plan"),
             py::arg("seed") = 1U,
             "The best layouts by determinant and by interpolation error, the plan's own first.");
  module.def("layout_score", &layout_score, py::arg("structure"), py::arg("sites"), py::arg("plan"),
             py::arg("sensors"), py::arg("actuators"),
             "Scores of some channels of the structure, by index: scores by criterion, "
             "blind_modes (counted from 1), collocated_pairs, deviation over the sites.");
}

}  // namespace chladni::python
