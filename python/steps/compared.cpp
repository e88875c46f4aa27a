// The comparison of a measurement with the simulation of a study from Python.
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "io/frf_file.h"
#include "python/result.h"
#include "python/rooms.h"
#include "python/values/frf_arrays.h"
#include "show/compared.h"
#include "steps/compared.h"

namespace chladni::python {
namespace {

namespace py = pybind11;

class ComparisonResult : public Result {
 public:
  ComparisonResult(std::shared_ptr<const OpenedStudy> opened, Said said,
                   steps::StudyComparison found)
      : Result(std::move(opened), std::move(said)), found_(std::move(found)) {}
  [[nodiscard]] std::string text() const override { return show::compared_text(found_, false); }
  [[nodiscard]] io::JsonObject json() const override { return show::compared_json(found_); }
  void leave(show::Run& run) const override { show::leave_compared(found_, run); }
  [[nodiscard]] const steps::StudyComparison& found() const { return found_; }

 private:
  steps::StudyComparison found_;
};

std::shared_ptr<ComparisonResult> compare(const py::object& source, const py::object& progress,
                                          std::optional<Seed> seed) {
  const auto subject = subject_of(source);
  PythonWork work(subject, {progress, seed});
  auto found = work.done([&] { return steps::compared(subject.study(), work); });
  return std::make_shared<ComparisonResult>(subject.opened, work.said(), std::move(found));
}

py::object compared_responses(const ComparisonResult& one) {
  if (one.found().modes) return py::none();
  const auto& measured = one.found().measured;
  return py::cast(std::make_shared<io::FrfFile>(io::FrfFile{measured.file, measured.all, {}}));
}

py::object simulated_responses(const ComparisonResult& one) {
  const auto& found = one.found();
  if (found.modes) return py::none();
  const auto& set = found.measured.all;
  return array_of<Complexes>(found.predictions.before, set.output_count(), set.input_count());
}

}  // namespace

void add_compare_step(py::module_& module) {
  using Class = py::class_<ComparisonResult, std::shared_ptr<ComparisonResult>, Result>;
  Class bound(module, "Comparison",
              "What was measured beside the simulation. Arrays are views; of measured modes, "
              "without responses, they are empty.");
  const auto view = [&bound](const char* name, auto member, const char* text) {
    bound.def_property_readonly(
        name,
        [member](const ComparisonResult& one) -> const auto& {
          return member(one.found().comparison);
        },
        text);
  };
  using diagnosis::Comparison;
  view(
      "error", [](const Comparison& c) -> const auto& { return c.responses.error; },
      "sensors x actuators: |measured - simulated| over |measured|, over all lines");
  view(
      "noise", [](const Comparison& c) -> const auto& { return c.responses.noise; },
      "likewise of the measurement's standard deviation; nan where none is stated");
  view(
      "band_edges_hz", [](const Comparison& c) -> const auto& { return c.responses.band_edges_hz; },
      "b + 1, of equal ratios");
  view(
      "band_error", [](const Comparison& c) -> const auto& { return c.responses.band_error; },
      "b, relative within each band; nan: no line");
  view(
      "mac", [](const Comparison& c) -> const auto& { return c.modes.mac; },
      "simulated x measured modes, at the sensors times at the actuators");
  bound
      .def_property_readonly("measured", &compared_responses,
                             "the responses, as receptances; None where modes were measured")
      .def_property_readonly("simulated", &simulated_responses,
                             "lines x sensors x actuators, on the lines of measured; or None");
  module.def("compare", &compare, py::arg("study"), py::kw_only(), py::arg("progress") = py::none(),
             py::arg("seed") = py::none(),
             "Measured against simulated modes and responses, without a search for causes. It "
             "solves with the modes that the measured band needs.");
}

}  // namespace chladni::python
