// Diagnosis of a study from Python.
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "io/frf_file.h"
#include "python/result.h"
#include "python/rooms.h"
#include "python/values/frf_arrays.h"
#include "python/values/python_json.h"
#include "show/diagnosis.h"
#include "show/report.h"
#include "show/specimens.h"
#include "steps/diagnosis.h"
#include "steps/specimens.h"

namespace chladni::python {
namespace {

namespace py = pybind11;

class DiagnosisResult : public Result {
 public:
  DiagnosisResult(std::shared_ptr<const OpenedStudy> opened, Said said, steps::Diagnosed found)
      : Result(std::move(opened), std::move(said)), found_(std::move(found)) {}
  [[nodiscard]] std::string text() const override { return show::diagnosis_table(found_, false); }
  [[nodiscard]] io::JsonObject json() const override { return show::diagnosis_json(found_); }
  void leave(show::Run& run) const override {
    auto left = found_;
    if (left.extended) lead_paths(run, left);
    show::leave_diagnosis(study(), left, run, true);
  }
  [[nodiscard]] std::string page() const override { return show::diagnosis_page(study(), found_); }
  [[nodiscard]] const steps::Diagnosed& found() const { return found_; }

 private:
  // Paths of the extended study start in the folder of the study until it is left elsewhere.
  void lead_paths(const stage::Work& work, steps::Diagnosed& left) const {
    auto allowed = opened()->allowed;
    const auto folder = std::filesystem::absolute(study().file).parent_path();
    allowed.push_back(folder);
    left.extended->text =
        steps::extended_study(left.extended->text, folder / "extended.toml", left.structure.surface,
                              {}, work.choices().folder, allowed)
            .text;
  }

  steps::Diagnosed found_;
};

class SpecimensResult : public Result {
 public:
  SpecimensResult(std::shared_ptr<const OpenedStudy> opened, Said said,
                  steps::DiagnosedSpecimens found)
      : Result(std::move(opened), std::move(said)), found_(std::move(found)) {}
  [[nodiscard]] std::string text() const override { return show::specimens_table(found_.result); }
  [[nodiscard]] io::JsonObject json() const override { return show::specimens_json(found_.result); }
  void leave(show::Run& run) const override { show::leave_specimens(found_, run); }

 private:
  steps::DiagnosedSpecimens found_;
};

py::object diagnose(const py::object& source, const py::object& progress,
                    std::optional<Seed> seed) {
  const auto subject = subject_of(source);
  PythonWork work(subject, {progress, seed});
  if (!subject.study().specimens.empty()) {
    auto found = work.done([&] { return steps::diagnosed_specimens(subject.study(), work); });
    return py::cast(
        std::make_shared<SpecimensResult>(subject.opened, work.said(), std::move(found)));
  }
  auto found = work.done([&] { return steps::diagnosed(subject.study(), work); });
  return py::cast(std::make_shared<DiagnosisResult>(subject.opened, work.said(), std::move(found)));
}

// The place of each cause in the body's frame [m]; None: it has no place.
py::list places_of(const DiagnosisResult& one) {
  py::list places;
  for (const auto& cause : one.found().result.best.causes) {
    if (cause.place) {
      places.append(Eigen::VectorXd(one.found().structure.surface.in_body(*cause.place)));
    } else {
      places.append(py::none());
    }
  }
  return places;
}

// Places of the scan in the body's frame, the part of the misfit that one thing there would
// explain, and the probability that it is there.
py::object cause_map(const DiagnosisResult& one) {
  const auto& map = one.found().result.map;
  if (map.explained.size() == 0) return py::none();
  const auto& surface = one.found().structure.surface;
  Points places(surface.count(), 3);
  for (Eigen::Index i = 0; i < surface.count(); ++i) {
    places.row(i) = surface.in_body(surface.places.row(i).transpose()).transpose();
  }
  return py::make_tuple(places, map.explained, map.posterior);
}

std::shared_ptr<io::FrfFile> measured_in(const DiagnosisResult& one) {
  const auto& measured = one.found().measured;
  return std::make_shared<io::FrfFile>(io::FrfFile{measured.file, measured.all, {}});
}

// Responses on the lines of `measured`: of the study, of the extended study, and of the fitted
// model; None where there are none.
py::tuple predictions_of(const DiagnosisResult& one) {
  const auto& set = one.found().measured.all;
  const auto array = [&](const std::vector<Eigen::MatrixXcd>& value) -> py::object {
    if (value.empty()) return py::none();
    return array_of<Complexes>(value, set.output_count(), set.input_count());
  };
  const auto& predictions = one.found().predictions;
  return py::make_tuple(array(predictions.before), array(predictions.extended),
                        array(predictions.fitted));
}

// The extended study; None: no cause was named. Its paths start where those of the study do.
py::object extended(const DiagnosisResult& one) {
  if (!one.found().extended) return py::none();
  const auto& study = one.study();
  const auto& allowed = one.opened()->allowed;
  const auto file = std::filesystem::absolute(study.file).parent_path() / "extended.toml";
  auto read = study::parse_study(one.found().extended->text, file, allowed);
  return py::cast(std::make_shared<OpenedStudy>(OpenedStudy{std::move(read), allowed}));
}

}  // namespace

void add_diagnosis_step(py::module_& module) {
  py::class_<DiagnosisResult, std::shared_ptr<DiagnosisResult>, Result>(
      module, "Diagnosis", "What a simulation gets wrong, and why.")
      .def("_places", &places_of)
      .def_property_readonly("cause_map", &cause_map,
                             "places n x 3 [m], part of the misfit that one thing in each place "
                             "would explain, probability of the cause there; or None")
      .def_property_readonly("measured", &measured_in, "the responses, as receptances")
      .def_property_readonly("predictions", &predictions_of,
                             "responses on the lines of measured: of the study, the extended "
                             "study, the fitted model; each lines x outputs x inputs, or None")
      .def_property_readonly("extended_text",
                             [](const DiagnosisResult& one) {
                               const auto& text = one.found().extended;
                               return text ? std::optional<std::string>(text->text) : std::nullopt;
                             })
      .def("extended_study", &extended, "The study with the causes; None where none was named.");
  py::class_<SpecimensResult, std::shared_ptr<SpecimensResult>, Result>(
      module, "SpecimensDiagnosis", "Several specimens of one design, diagnosed together.");
  module.def("diagnose", &diagnose, py::arg("study"), py::kw_only(),
             py::arg("progress") = py::none(), py::arg("seed") = py::none(),
             "What the simulation gets wrong, its causes, the extended study and the gain.");
}

}  // namespace chladni::python
