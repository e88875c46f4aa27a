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
#include "placement/criteria.h"
#include "python/calls/long_call.h"
#include "python/rooms.h"
#include "python/values/given.h"
#include "python/values/seed.h"

namespace chladni::python {
namespace {

namespace py = pybind11;
using placement::Plan;

constexpr int kMostPairs = 100;  // as in a study

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

// As the keys of [placement] are refused.
void require_meant(const Plan& plan) {
  static_cast<void>(placement::criterion(plan.criterion));
  require(plan.up_to_hz >= 0.0,
          fmt::format("plan.up_to_hz is {:g}; expected 0 or more", plan.up_to_hz));
  require_not_negative(plan.frequency_tolerance, "plan.frequency_tolerance");
  require_positive(plan.noise, "plan.noise");
  require_not_negative(plan.position_error, "plan.position_error");
  require_not_negative(plan.spacing, "plan.spacing");
  require(plan.pairs >= 1 && plan.pairs <= kMostPairs,
          fmt::format("plan.pairs is {}; expected 1 to {}", plan.pairs, kMostPairs));
  require_not_negative(plan.sites, "plan.sites");
}

using Position = Given<"position", Points>;
using Direction = Given<"direction", Points>;
using Shapes = Given<"shapes", Eigen::MatrixXd>;

ArraySites surface_sites(const Position& position, const Given<"area", Eigen::VectorXd>& area,
                         const Shapes& shapes,
                         const std::optional<Given<"slopes", Eigen::MatrixXd>>& slopes) {
  const auto count = position.value.rows();
  for (Eigen::Index i = 0; i < count; ++i) {
    require(position.value.row(i).allFinite(),
            fmt::format("the position of place {} is not finite; expected x, y and z [m]", i));
  }
  for (Eigen::Index i = 0; i < area.value.size(); ++i) {
    require_not_negative(area.value(i), fmt::format("the area of place {}", i));
  }
  ArraySites sites;
  sites.position = position.value;
  sites.normal = Points::Zero(count, 3);
  sites.patch = Eigen::VectorXi::Zero(count);
  sites.area = area.value;
  sites.shapes = shapes.value;
  sites.has_slopes = slopes.has_value();
  sites.slopes =
      value_of(slopes).value_or(Eigen::MatrixXd::Zero(shapes.value.rows(), shapes.value.cols()));
  sites.whole.assign(static_cast<std::size_t>(count), 1);
  return sites;
}

placement::Channels channel_rows(const Position& position, const Direction& direction,
                                 const Shapes& shapes, const std::vector<bool>& stays) {
  placement::Channels channels{{position.value, direction.value}, shapes.value, {}};
  for (const bool stay : stays) channels.stays.push_back(stay ? 1 : 0);
  return channels;
}

placement::Structure structure_with(
    const Given<"frequency_hz", Eigen::VectorXd>& frequency_hz, double mass_kg, double size,
    const std::optional<Given<"damping_ratio", Eigen::VectorXd>>& damping,
    const placement::Channels& sensors, const placement::Channels& actuators) {
  const auto& f = frequency_hz.value;
  require_frequencies(f);
  require_positive(mass_kg, "mass_kg");
  require_positive(size, "size");
  placement::Structure structure;
  structure.frequency_hz = f;
  structure.damping_ratio = value_of(damping).value_or(Eigen::VectorXd::Zero(f.size()));
  for (const double zeta : structure.damping_ratio) {
    require(std::isfinite(zeta) && zeta >= 0.0,
            fmt::format("damping_ratio has {:g}; expected 0 or more", zeta));
  }
  structure.rigid_count = (f.array() == 0.0).count();
  structure.mass_kg = mass_kg;
  structure.size = size;
  structure.sensors = sensors;
  structure.actuators = actuators;
  return structure;
}

void require_sound(const ArraySites& surface, const Plan& plan) {
  require_meant(plan);
  require_slopes(surface, plan);
}

placement::WantedModes wanted(const placement::Structure& structure, const ArraySites& surface,
                              const Plan& plan) {
  std::vector<std::string> notes;
  return placement::wanted_modes(structure, surface, plan, notes);
}

std::vector<placement::BestPair> best_pairs(const placement::Structure& structure,
                                            const ArraySites& surface, const Plan& plan) {
  require_sound(surface, plan);
  const LongCall call;
  const placement::PairViews views(structure, surface, wanted(structure, surface, plan), plan);
  const auto places = placement::best_pairs(views, surface, {surface, true}, plan, nullptr, {});
  return plan.pairs > 1 ? places.pairs : places.best;
}

std::vector<placement::Optimum> best_layouts(const placement::Structure& structure,
                                             const ArraySites& surface, const Plan& plan,
                                             Seed seed) {
  require_sound(surface, plan);
  const LongCall call;
  return placement::best_layouts(structure, surface, {surface, true},
                                 wanted(structure, surface, plan), plan, seed.value);
}

std::vector<std::size_t> indices_of(const std::vector<long long>& given) {
  std::vector<std::size_t> indices;
  for (const auto index : given) {
    require(index >= 0,
            fmt::format("channel {} of a layout does not exist; expected 0 or more", index));
    indices.push_back(static_cast<std::size_t>(index));
  }
  return indices;
}

py::dict layout_score(const placement::Structure& structure, const ArraySites& surface,
                      const Plan& plan, const std::vector<long long>& sensors,
                      const std::vector<long long>& actuators) {
  require_sound(surface, plan);
  const auto score = [&] {
    const LongCall call;
    return placement::LayoutScorer(structure, surface, wanted(structure, surface, plan), plan)
        .of_channels(indices_of(sensors), indices_of(actuators));
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
