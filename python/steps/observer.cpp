// The observer of a study from Python.
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "python/result_of_modes.h"
#include "python/rooms.h"
#include "python/values/given.h"
#include "show/observer.h"
#include "steps/observed.h"
#include "steps/predicted.h"

namespace chladni::python {
namespace {

namespace py = pybind11;

class ObserverResult : public ResultOfModes<steps::Observed> {
 public:
  using ResultOfModes::ResultOfModes;
  [[nodiscard]] std::string text() const override { return show::observer_table(found()); }
  [[nodiscard]] io::JsonObject json() const override { return show::observer_json(found()); }
  void leave(show::Run& run) const override { show::leave_observer(study(), found(), run); }
  [[nodiscard]] const steps::Observer& observer() const { return found().observer; }
  [[nodiscard]] const modal::KalmanFilter& filter() const { return observer().filter; }
};

std::shared_ptr<ObserverResult> observe(const py::object& source, const py::object& progress,
                                        std::optional<Seed> seed) {
  auto made =
      made_by<ObserverResult>(source, {progress, seed}, steps::observed, steps::require_observer);
  const auto& judgement = steps::identified_of(*made->observer().shapes).judgement;
  if (judgement.trust == identification::Trust::none) warn_python(judgement.reasons);
  return made;
}

py::tuple estimate_of(const ObserverResult& one, const Given<"inputs", Eigen::MatrixXd>& inputs,
                      const Given<"sensors", Eigen::MatrixXd>& sensors) {
  auto [points, deviation] = [&] {
    const LongCall call;
    auto found = modal::estimate(one.filter(), inputs.value, sensors.value, true);
    return std::pair(std::move(found.points), steps::band(one.observer(), found.states));
  }();
  return py::make_tuple(std::move(points), std::move(deviation));
}

using ObserverClass = py::class_<ObserverResult, std::shared_ptr<ObserverResult>, Result>;

void add_deviations(ObserverClass& bound) {
  const auto view = [&bound](const char* name, auto member, const char* text) {
    bound.def_property_readonly(
        name, [member](const ObserverResult& one) -> const auto& { return member(one.observer()); },
        text);
  };
  using steps::Observer;
  view(
      "deviation_m", [](const Observer& o) -> const auto& { return o.deviation; },
      "of each point's estimate with this sample's sensors [m]");
  view(
      "prediction_deviation_m", [](const Observer& o) -> const auto& { return o.prediction; },
      "likewise from the samples before [m]");
  view(
      "deviation_without_sensors_m", [](const Observer& o) -> const auto& { return o.without; },
      "of the motion under the disturbances alone [m]; infinite where it drifts");
  view(
      "shape_deviation_m", [](const Observer& o) -> const auto& { return o.shape_deviation; },
      "what the uncertain shape adds under the disturbances [m]; infinite where it is not known");
  view(
      "unknown_part", [](const Observer& o) -> const auto& { return o.unknown_part; },
      "of each mode's motion, which the sensors leave unknown");
  view(
      "L", [](const Observer& o) -> const auto& { return o.filter.gain; },
      "n x p: of the innovations to the next state");
  view(
      "L_points", [](const Observer& o) -> const auto& { return o.filter.point_gain; },
      "z x p: of the innovations to the points");
  view(
      "P", [](const Observer& o) -> const auto& { return o.filter.covariance; },
      "n x n: covariance of the state from all earlier samples");
  view(
      "innovation_covariance", [](const Observer& o) -> const auto& { return o.filter.innovation; },
      "p x p [m^2]");
  view(
      "points_covariance",
      [](const Observer& o) -> const auto& { return o.filter.point_covariance; },
      "z x z [m^2], with this sample's sensors");
}

}  // namespace

void add_observer_step(py::module_& module) {
  ObserverClass bound(
      module, "Observer",
      "The motion where no sensor is, from the sensors there are. Arrays are views.");
  add_deviations(bound);
  bound
      .def_property_readonly("sample_time_s",
                             [](const ObserverResult& o) { return o.observer().sample_time_s; })
      .def_property_readonly(
          "points", [](const ObserverResult& o) { return o.observer().names(); },
          "names: those of the study, then the held-out sensors")
      .def_property_readonly(
          "filter", [](const ObserverResult& o) { return modal::observer_model(o.filter()); },
          "A StateSpace, which steps by itself: from the known forces and the sensors to the "
          "points "
          "and the innovations.")
      .def_property_readonly(
          "disturbed_model", [](const ObserverResult& o) { return o.filter().system.model; },
          "A StateSpace: the sampled plant on which the filter stands, from the known forces and "
          "the white noise to the sensors and the points.")
      .def("estimate", &estimate_of, py::arg("inputs"), py::arg("sensors"),
           "Motion of the points [m] and its deviation, each samples x points, from rest. inputs: "
           "samples x known forces [N]; sensors: samples x sensors, in SI.");
  module.def("observe", &observe, py::arg("study"), py::kw_only(), py::arg("progress") = py::none(),
             py::arg("seed") = py::none(),
             "A Kalman filter on the identified model, and its trial on recordings.");
}

}  // namespace chladni::python
