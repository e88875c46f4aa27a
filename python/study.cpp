// Studies from Python, and what all results of one have.
#include "study/study.h"

#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "base/text_stream.h"
#include "python/modes_result.h"
#include "python/result.h"
#include "python/rooms.h"
#include "python/values/python_json.h"
#include "show/solution.h"
#include "steps/checked.h"
#include "steps/expectations.h"

namespace chladni::python {
namespace {

namespace py = pybind11;
using Folders = std::vector<std::filesystem::path>;
using StudyClass = py::class_<OpenedStudy, std::shared_ptr<OpenedStudy>>;

std::filesystem::path absolute_path(const py::object& given) {
  return py::module_::import("os").attr("fspath")(given).cast<std::filesystem::path>();
}

// From a file, or from a dict (or another mapping) with the structure of one.
std::shared_ptr<OpenedStudy> opened(const py::object& source, const py::object& folder,
                                    const std::string& name, const Folders& allowed) {
  if (!py::isinstance(source, py::module_::import("collections.abc").attr("Mapping"))) {
    require(folder.is_none() && name.empty(),
            "folder and name are for a study from a dict; one from a file has its own");
    return std::make_shared<OpenedStudy>(
        OpenedStudy{study::read_study(absolute_path(source), allowed), allowed});
  }
  const auto text =
      py::module_::import("chladni._toml").attr("toml_text")(source).cast<std::string>();
  auto file = folder.is_none() ? std::filesystem::path() : absolute_path(folder);
  file /= (name.empty() ? "study" : name) + ".toml";
  return std::make_shared<OpenedStudy>(
      OpenedStudy{study::parse_study(text, file, allowed), allowed});
}

py::object checked(const std::shared_ptr<OpenedStudy>& opened, bool expect,
                   const py::object& progress) {
  const Subject subject{opened, {}};
  PythonWork work(subject, {.progress = progress});
  auto json = work.done([&] {
    const auto& study = opened->study;
    if (expect) steps::require_expectations(study);
    auto introduction = steps::checked(study, !expect, work);
    auto resolved = show::study_json(study, introduction);
    if (!expect) return resolved;
    const auto solution = stage::solved(study, std::move(introduction), work);
    const auto judged = steps::judged(study, solution, work);
    show::add_judged(judged, resolved);
    steps::require_met(study, judged, solution);
    return resolved;
  });
  static_cast<void>(work.said());
  return python_of(std::move(json));
}

std::string repr_of(const OpenedStudy& opened) {
  return fmt::format("<chladni.Study \"{}\" of {}>", opened.study.title,
                     opened.study.file.string());
}

// Writes what the verb of the result leaves; what it warns of are warnings of Python.
void save(const Result& result, const std::filesystem::path& folder, bool pictures,
          const py::object& progress) {
  show::Options options;
  options.folder = folder;
  options.pictures = pictures;
  options.allowed = result.opened()->allowed;
  options.seed = result.said().seed;
  TextWriter shown;
  TextWriter told;
  PythonWork work({result.opened(), {}}, {.progress = progress});
  work.done([&] {
    show::Talk talk(told, {.quiet = true});
    show::Run run(result.study(), options, shown, talk);
    tell(work.progress(), "writing");
    result.leave(run);
    run.finish_pictures();
  });
  std::vector<std::string> warnings;
  TextReader lines(told.str());
  constexpr std::string_view mark = "warning: ";
  for (std::string line; std::getline(lines, line);) {
    warnings.push_back(line.starts_with(mark) ? line.substr(mark.size()) : line);
  }
  warn_python(warnings);
}

std::string page_of(const Result& result) {
  const LongCall call;
  return result.page();
}

void add_study(StudyClass& bound) {
  bound
      .def(py::init(&opened), py::arg("source"), py::kw_only(), py::arg("folder") = py::none(),
           py::arg("name") = "", py::arg("allow_outside") = Folders{},
           "From a TOML file, or from a dict with its structure. Paths in a dict start at folder "
           "(the current one); name is that of messages and of default output folders.")
      .def("check", &checked, py::kw_only(), py::arg("expect") = false,
           py::arg("progress") = py::none(),
           "The study in SI units with its estimated size, memory and time: study.json. With "
           "expect its modes are computed and compared with what it expects.")
      .def_property_readonly("title", [](const OpenedStudy& one) { return one.study.title; })
      .def_property_readonly("name", [](const OpenedStudy& one) { return one.study.name; })
      .def_property_readonly("file", [](const OpenedStudy& one) { return one.study.file; })
      .def_property_readonly("text", [](const OpenedStudy& one) { return one.study.text; })
      .def_property_readonly("sha256", [](const OpenedStudy& one) { return one.study.sha256; })
      .def_property_readonly("warnings", [](const OpenedStudy& one) { return one.study.warnings; })
      .def_property_readonly(
          "sensors", [](const OpenedStudy& one) { return study::names_of(one.study.sensors); })
      .def_property_readonly(
          "actuators", [](const OpenedStudy& one) { return study::names_of(one.study.actuators); })
      .def("__repr__", &repr_of);
}

void add_result(py::module_& module) {
  py::class_<Result, std::shared_ptr<Result>>(module, "Result", "What all results have.")
      .def("__str__", &Result::text)
      .def(
          "to_dict", [](const Result& result) { return python_of(result.json()); },
          "The content of the JSON file that the verb leaves.")
      .def("save", &save, py::arg("folder"), py::kw_only(), py::arg("pictures") = true,
           py::arg("progress") = py::none(), "Leaves the files of the verb in folder.")
      .def("_page", &page_of)
      .def_property_readonly("study",
                             [](const Result& result) {
                               return std::const_pointer_cast<OpenedStudy>(result.opened());
                             })
      .def_property_readonly("notes", [](const Result& result) { return result.said().notes; })
      .def_property_readonly("warnings",
                             [](const Result& result) { return result.said().warnings; })
      .def_property_readonly(
          "seconds",
          [](const Result& result) {
            py::dict seconds;
            for (const auto& [part, time] : result.said().seconds) seconds[py::str(part)] = time;
            return seconds;
          },
          "Wall time of each part of the step.");
}

}  // namespace

Subject subject_of(const py::object& given) {
  if (py::isinstance<ModesResult>(given)) {
    const auto modes = given.cast<std::shared_ptr<ModesResult>>();
    return {modes->opened(), modes->solution()};
  }
  if (py::isinstance<OpenedStudy>(given)) return {given.cast<std::shared_ptr<OpenedStudy>>(), {}};
  return {opened(given, py::none(), "", {}), {}};
}

void add_studies(py::module_& module) {
  StudyClass bound(module, "Study", "What a body is and what is wanted of it.");
  add_study(bound);
  add_result(module);
}

}  // namespace chladni::python
