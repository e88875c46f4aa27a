// Virtual experiments, identification and interpolation of a study from Python.
#include <pybind11/complex.h>
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>

#include "identification/modal_fit.h"
#include "io/frf_file.h"
#include "io/time_file.h"
#include "python/modes_result.h"
#include "python/rooms.h"
#include "python/values/frf_arrays.h"
#include "python/values/given.h"
#include "show/control_models.h"
#include "show/identification.h"
#include "show/interpolation.h"
#include "stage/points_on_body.h"
#include "steps/checked.h"
#include "steps/control_models.h"
#include "steps/fitted.h"
#include "steps/predicted.h"
#include "steps/simulated.h"

namespace chladni::python {
namespace {

namespace py = pybind11;

class IdentifiedResult : public Result {
 public:
  IdentifiedResult(std::shared_ptr<const OpenedStudy> opened, Said said,
                   std::shared_ptr<const steps::IdentifiedModel> model)
      : Result(std::move(opened), std::move(said)), model_(std::move(model)) {}
  [[nodiscard]] std::string text() const override {
    return show::identification_text(study(), *model_);
  }
  [[nodiscard]] io::JsonObject json() const override {
    return show::identified_json(study(), *model_);
  }
  void leave(show::Run& run) const override {
    show::leave_identification(study(), *model_, run, true);
  }
  [[nodiscard]] const steps::IdentifiedModel& model() const { return *model_; }
  [[nodiscard]] const identification::ModalFit& fit() const { return model_->found.fit; }

 private:
  std::shared_ptr<const steps::IdentifiedModel> model_;
};

// The interpolated shapes of a study, with the solution that they are based on.
class StudyField : public Result {
 public:
  StudyField(const Subject& subject, Said said, steps::Interpolated found)
      : Result(subject.opened, std::move(said)),
        solution_(subject.solution),
        found_(std::move(found)),
        finder_(solution_->model.body) {}
  [[nodiscard]] std::string text() const override { return show::interpolation_table(found_); }
  [[nodiscard]] io::JsonObject json() const override { return show::interpolation_json(found_); }
  void leave(show::Run& run) const override {
    if (found_.measured.identified) {
      show::leave_identification(study(), *found_.measured.identified, run, false);
    }
    show::leave_interpolation(study(), *solution_, found_, run, true);
  }
  [[nodiscard]] const steps::Interpolated& found() const { return found_; }

  [[nodiscard]] priors::Places places_near(const Points& points,
                                           const std::optional<Points>& direction) const {
    const auto sites = stage::sites_near(finder_, points, stage::reach_of(solution_->model.body));
    return steps::places_at(sites, stage::directions_at(sites, direction), solution_->modes,
                            found_.harmonics);
  }
  [[nodiscard]] const steps::Interpolation& by(const std::string& method) const {
    return steps::interpolation_called(found_, method);
  }

 private:
  std::shared_ptr<const stage::Solution> solution_;
  steps::Interpolated found_;
  mesh::SiteFinder finder_;
};

std::shared_ptr<IdentifiedResult> identify(const py::object& source, const py::object& progress,
                                           std::optional<Seed> seed) {
  const auto subject = subject_of(source);
  PythonWork work(subject, {progress, seed});
  auto model = work.done([&] {
    return std::make_shared<const steps::IdentifiedModel>(
        steps::identified(subject.study(), subject.solution.get(), work));
  });
  auto said = work.said();
  if (model->judgement.trust == identification::Trust::none) warn_python(model->judgement.reasons);
  return std::make_shared<IdentifiedResult>(subject.opened, std::move(said), std::move(model));
}

std::shared_ptr<StudyField> interpolate(const py::object& source,
                                        const std::optional<std::filesystem::path>& folder,
                                        const py::object& progress, std::optional<Seed> seed) {
  auto subject = subject_of(source);
  PythonWork work(subject, {progress, seed});
  auto found = work.done([&] {
    steps::require_measured(subject.study());
    solve(subject, work);
    return steps::interpolated(subject.study(), *subject.solution, work);
  });
  auto field = std::make_shared<StudyField>(subject, work.said(), std::move(found));
  if (folder) py::cast(field).attr("save")(*folder, py::arg("pictures") = false);
  return field;
}

// The responses and the recordings of a virtual experiment.
py::tuple simulate(const py::object& source, const py::object& progress, std::optional<Seed> seed) {
  const auto subject = subject_of(source);
  require(subject.study().experiment.has_value(),
          "the study has no [experiment]; expected one, such as [experiment] noise = \"2 nm\"");
  PythonWork work(subject, {progress, seed});
  std::vector<std::string> notes;
  auto found = work.done([&] {
    const auto bench = steps::bench_of(subject.study(), work);
    notes = bench.notes;
    return steps::simulated(subject.study(), bench, work);
  });
  static_cast<void>(work.said());
  const auto& more = found.estimate.notes;
  notes.insert(notes.end(), more.begin(), more.end());
  py::object recordings = py::none();
  if (subject.study().experiment->leaves_time) {
    recordings = py::cast(std::make_shared<io::TimeFile>(
        io::TimeFile{"virtual experiment", std::move(found.recordings), notes}));
  }
  return py::make_tuple(std::make_shared<io::FrfFile>(io::FrfFile{
                            "virtual experiment", std::move(found.estimate.set), notes}),
                        recordings);
}

using Lines = Given<"frequency_hz", Eigen::VectorXd>;
using GivenPoints = Given<"points", Points>;
using Direction = std::optional<Given<"direction", Points>>;

std::shared_ptr<io::FrfFile> fitted_responses(const IdentifiedResult& one,
                                              const Lines& frequency_hz) {
  require_lines(frequency_hz.value);
  const LongCall call;
  return std::make_shared<io::FrfFile>(
      io::FrfFile{"modal model", steps::fitted_responses(one.model(), frequency_hz.value), {}});
}

modal::ControlModel fitted_state_space(const IdentifiedResult& one, double sample_rate_hz,
                                       int states, int pade_order) {
  const auto asked = with_state_space(one.study(), sample_rate_hz, states, pade_order);
  const auto models = [&] {
    const LongCall call;
    return steps::control_models(asked, one.model());
  }();
  warn_python(models.notes);
  return sample_rate_hz > 0.0 ? *models.discrete : models.continuous;
}

py::tuple shapes_near(const StudyField& field, const GivenPoints& points,
                      const Direction& direction, const std::string& method) {
  auto found = [&] {
    const LongCall call;
    return steps::field_at(field.by(method), field.places_near(points.value, value_of(direction)));
  }();
  return py::make_tuple(std::move(found.mean), std::move(found.deviation));
}

py::tuple responses_near(const StudyField& field, const GivenPoints& points,
                         const Lines& frequency_hz, const Direction& direction,
                         const std::string& method) {
  require_frequencies(frequency_hz.value);
  const auto found = [&] {
    const LongCall call;
    return steps::responses_at(field.found(), field.by(method),
                               field.places_near(points.value, value_of(direction)),
                               frequency_hz.value);
  }();
  const auto inputs = steps::identified_of(field.found()).found.fit.model.input_count();
  return py::make_tuple(array_of<Complexes>(found.value, points.value.rows(), inputs),
                        array_of<Numbers>(found.deviation, points.value.rows(), inputs));
}

py::object identified_in(const StudyField& field) {
  const auto& model = field.found().measured.identified;
  if (!model) return py::none();
  return py::cast(std::make_shared<IdentifiedResult>(field.opened(), field.said(), model));
}

using IdentifiedClass = py::class_<IdentifiedResult, std::shared_ptr<IdentifiedResult>, Result>;

void add_identified_arrays(IdentifiedClass& bound) {
  const auto view = [&bound](const char* name, auto member, const char* text) {
    bound.def_property_readonly(
        name, [member](const IdentifiedResult& one) -> const auto& { return member(one.model()); },
        text);
  };
  using Model = steps::IdentifiedModel;
  view(
      "frequency_hz", [](const Model& m) -> const auto& { return m.found.fit.model.frequency_hz; },
      "m; rigid-body modes first with 0");
  view(
      "frequency_std_hz",
      [](const Model& m) -> const auto& { return m.found.fit.frequency_std_hz; }, "m");
  view(
      "damping_ratio",
      [](const Model& m) -> const auto& { return m.found.fit.model.damping_ratio; }, "m");
  view(
      "damping_std", [](const Model& m) -> const auto& { return m.found.fit.damping_std; }, "m");
  view(
      "output_matrix",
      [](const Model& m) -> const auto& { return m.found.fit.model.output_shapes; }, "L, p x m");
  view(
      "output_std", [](const Model& m) -> const auto& { return m.found.fit.output_std; }, "p x m");
  view(
      "input_matrix", [](const Model& m) -> const auto& { return m.found.fit.model.input_shapes; },
      "R, m x q");
  view(
      "input_std", [](const Model& m) -> const auto& { return m.found.fit.input_std; }, "m x q");
  view(
      "residual", [](const Model& m) -> const auto& { return m.found.fit.model.residual; },
      "p x q [m/N]: the modes above the band");
  view(
      "shapes", [](const Model& m) -> const auto& { return m.match.shapes; },
      "mass-normalised shapes at all places [kg^-1/2], in one scale for both sides");
  view(
      "shapes_std", [](const Model& m) -> const auto& { return m.match.deviation; },
      "of shapes; infinite where a mode has no known scale");
}

void add_identified(py::module_& module) {
  IdentifiedClass bound(module, "Identified",
                        "A modal model of measured responses. Arrays are views.");
  add_identified_arrays(bound);
  bound
      .def_property_readonly(
          "poles", [](const IdentifiedResult& i) { return steps::poles(i.model()); },
          "m [rad/s], above the real axis")
      .def_property_readonly("delay_s", [](const IdentifiedResult& i) { return i.fit().delay_s; })
      .def_property_readonly("delay_std_s",
                             [](const IdentifiedResult& i) { return i.fit().delay_std_s; })
      .def_property_readonly(
          "trust",
          [](const IdentifiedResult& i) { return identification::word(i.model().judgement.trust); },
          "\"down to the noise\", \"good\", \"systematic errors\" or \"not to be trusted\"")
      .def_property_readonly(
          "error", [](const IdentifiedResult& i) { return steps::overall_error(i.model()); },
          "|G - model| over |G|, over all responses and lines")
      .def_property_readonly(
          "noise", [](const IdentifiedResult& i) { return steps::noise(i.model()); },
          "the error of a perfect model")
      .def_property_readonly(
          "measured",
          [](const IdentifiedResult& i) {
            return std::make_shared<io::FrfFile>(
                io::FrfFile{i.model().measured.file, i.model().seen, {}});
          },
          "the responses that the fit saw")
      .def("frf", &fitted_responses, py::arg("frequency_hz"),
           "Receptances of the model between its channels, delays included.")
      .def("state_space", &fitted_state_space, py::kw_only(), py::arg("sample_rate_hz") = 0.0,
           py::arg("states") = 0, py::arg("pade_order") = 0,
           "From the actuators to the sensors; discrete with a sample rate.");
}

void add_field(py::module_& module) {
  py::class_<StudyField, std::shared_ptr<StudyField>, Result>(
      module, "StudyField", "Mode shapes on the body of a study, and its responses there.")
      .def(
          "at", &shapes_near, py::arg("points"), py::arg("direction") = py::none(),
          py::arg("method") = "",
          "Mean and standard deviation, each n x m, at the places of the surface nearest to points "
          "(n x 3 [m], within 1 mm), along direction (3 or n x 3) or the outward normal.")
      .def("frf", &responses_near, py::arg("points"), py::arg("frequency_hz"),
           py::arg("direction") = py::none(), py::arg("method") = "",
           "G between the sensors: value and standard deviation, each lines x n x actuators "
           "[m/N]. Needs measured responses.")
      .def_property_readonly(
          "frequency_hz", [](const StudyField& field) -> const auto& {
            return field.found().measured.shapes.frequency_hz;
          },
          "of the measured modes")
      .def_property_readonly("methods",
                             [](const StudyField& field) {
                               std::vector<std::string> names;
                               for (const auto& one : field.found().methods) {
                                 names.emplace_back(one.method->name);
                               }
                               return names;
                             })
      .def_property_readonly("identified", &identified_in,
                             "the modal model, where responses were measured");
}

}  // namespace

void add_identification_step(py::module_& module) {
  add_identified(module);
  add_field(module);
  module.def("_simulate", &simulate, py::arg("study"), py::arg("progress"), py::arg("seed"));
  module.def("identify", &identify, py::arg("study"), py::kw_only(),
             py::arg("progress") = py::none(), py::arg("seed") = py::none(),
             "A modal model of the study's measured responses.");
  module.def("interpolate", &interpolate, py::arg("study"), py::arg("folder") = py::none(),
             py::kw_only(), py::arg("progress") = py::none(), py::arg("seed") = py::none(),
             "Shapes between the sensors. With a folder the files of the verb are left there, "
             "without pictures.");
}

}  // namespace chladni::python
