// Figures for a paper from Python.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "app/command.h"
#include "base/text_stream.h"
#include "io/json.h"
#include "python/calls/long_call.h"
#include "python/rooms.h"
#include "python/values/python_json.h"

namespace chladni::python {
namespace {

namespace py = pybind11;
using FigureNames = std::vector<std::string>;
using NameOrNames = std::optional<std::variant<std::string, FigureNames>>;

FigureNames names_in(const NameOrNames& given) {
  if (!given) return {};
  if (const auto* one = std::get_if<std::string>(&*given)) return {*one};
  return std::get<FigureNames>(*given);
}

py::object figure(const std::filesystem::path& results, const NameOrNames& name,
                  const std::optional<std::filesystem::path>& folder, double width_mm, double dpi,
                  const FigureNames& formats, bool draw) {
  app::Figures asked;
  asked.results = results;
  asked.names = names_in(name);
  asked.output = folder.value_or(std::filesystem::path());
  asked.formats = formats;
  asked.width_mm = width_mm;
  asked.dpi = dpi;
  asked.list = !draw;
  asked.json = true;
  TextWriter told;
  {
    const LongCall call;
    static_cast<void>(app::figure(asked, told));
  }
  return python_of(io::parse_json(told.str()));
}

}  // namespace

void add_figure(py::module_& module) {
  module.def("figure", &figure, py::arg("results"), py::arg("name") = py::none(), py::kw_only(),
             py::arg("folder") = py::none(), py::arg("width_mm") = 160.0, py::arg("dpi") = 300.0,
             py::arg("formats") = FigureNames{"svg", "png"}, py::arg("draw") = true,
             "Draws figures for a paper, all or those with the names, from results that a verb or "
             "save() left; folder [that of the results]. Gives what `chladni figure --json` "
             "prints. draw=False: only which there are.");
}

}  // namespace chladni::python
