// Sweeps from Python.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "app/sweep.h"
#include "base/text_stream.h"
#include "python/calls/python_work.h"
#include "python/rooms.h"
#include "python/values/python_json.h"

namespace chladni::python {
namespace {

namespace py = pybind11;
using Folders = std::vector<std::filesystem::path>;

app::SweepCommand command_of(const std::filesystem::path& plan,
                             const std::optional<std::filesystem::path>& folder,
                             const Folders& allowed, bool pictures) {
  app::SweepCommand command;
  command.plan = plan;
  command.folder = folder.value_or(std::filesystem::path());
  command.allowed = allowed;
  command.json = true;
  command.pictures = pictures;
  return command;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  TextReader stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

py::object sweep(const std::filesystem::path& plan,
                 const std::optional<std::filesystem::path>& folder, int jobs, int threads,
                 bool retry, const Folders& allowed, bool pictures, const py::object& progress) {
  auto command = command_of(plan, folder, allowed, pictures);
  command.program = program();
  command.jobs = jobs;
  command.threads = threads;
  command.retry = retry;
  TextWriter results;
  TextWriter said;
  PythonWork work(Asked{.progress = progress});
  work.done([&] { return app::sweep(command, results, said, work.progress()); });
  warn_python(lines_of(said.str()));
  return python_of(io::parse_json(results.str()));
}

py::object gather(const std::filesystem::path& plan,
                  const std::optional<std::filesystem::path>& folder, const Folders& allowed,
                  bool pictures) {
  const auto command = command_of(plan, folder, allowed, pictures);
  TextWriter results;
  TextWriter said;
  {
    const LongCall call;
    static_cast<void>(app::gather(command, results, said));
  }
  warn_python(lines_of(said.str()));
  return python_of(io::parse_json(results.str()));
}

}  // namespace

void add_sweep(py::module_& module) {
  module.def("sweep", &sweep, py::arg("plan"), py::arg("folder") = py::none(), py::kw_only(),
             py::arg("jobs") = 0, py::arg("threads") = 1, py::arg("retry") = false,
             py::arg("allow_outside") = Folders{}, py::arg("pictures") = false,
             py::arg("progress") = py::none(),
             "Runs the variants that have not run, each by the program chladni, and gives the "
             "gathered results; folder [out/<plan's name>].");
  module.def("gather", &gather, py::arg("plan"), py::arg("folder") = py::none(), py::kw_only(),
             py::arg("allow_outside") = Folders{}, py::arg("pictures") = false,
             "The results that the variants have left.");
}

}  // namespace chladni::python
