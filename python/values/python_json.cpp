#include "python/values/python_json.h"

#include <cmath>

namespace chladni::python {
namespace {

namespace py = pybind11;

py::object object_of(std::monostate /*null*/) { return py::none(); }
py::object object_of(bool value) { return py::bool_(value); }
py::object object_of(long long value) { return py::int_(value); }
py::object object_of(double value) {
  return std::isfinite(value) ? py::object(py::float_(value)) : py::object(py::none());
}
py::object object_of(const std::string& value) { return py::str(value); }

py::object object_of(const io::JsonArray& values) {
  py::list list;
  for (const auto& value : values) list.append(python_of(value));
  return list;
}

py::object object_of(const io::JsonObject& members) {
  py::dict dict;
  for (const auto& [key, value] : members) dict[py::str(key)] = python_of(value);
  return dict;
}

}  // namespace

py::object python_of(const io::Json& json) {
  return std::visit([](const auto& value) -> py::object { return object_of(value); }, json.value());
}

}  // namespace chladni::python
