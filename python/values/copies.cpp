#include "python/values/copies.h"

#include <fmt/format.h>
#include <pybind11/complex.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "python/values/frf_arrays.h"

namespace chladni::python {
namespace {

namespace py = pybind11;
using modal::MeasuredChannel;
using NamesWithUnits = std::vector<std::pair<std::string, std::string>>;

void require_size(const py::tuple& state, std::size_t size) {
  require(state.size() == size,
          fmt::format("a copy has {} parts; expected {}, as this version of chladni writes them",
                      state.size(), size));
}

std::vector<Eigen::MatrixXd> lines_in(const py::object& given, const modal::FrfSet& set) {
  if (given.is_none()) return {};
  return matrices_of<Eigen::MatrixXd>(array_in<Numbers>(given, "a copied array"), "a copied array",
                                      set.output_count(), set.input_count());
}

NamesWithUnits told(const std::vector<modal::Signal>& signals) {
  NamesWithUnits names;
  for (const auto& one : signals) names.emplace_back(one.name, one.unit);
  return names;
}

std::vector<modal::Signal> signals_in(const py::handle& given) {
  std::vector<modal::Signal> signals;
  for (const auto& [name, unit] : given.cast<NamesWithUnits>()) signals.push_back({name, unit});
  return signals;
}

extern "C" PyObject* new_object(PyTypeObject* type, PyObject* /*given*/, PyObject* /*named*/) {
  return py::detail::make_new_instance(type);
}

}  // namespace

py::tuple state_of(const MeasuredChannel& channel) {
  return py::make_tuple(channel.name, channel.node, channel.direction, channel.position,
                        channel.unit, static_cast<int>(channel.kind));
}

MeasuredChannel channel_of(const py::tuple& state) {
  require_size(state, 6);
  const auto kind = state[5].cast<int>();
  require(kind >= 0 && kind <= static_cast<int>(modal::FrfKind::accelerance),
          fmt::format("a copied channel has the quantity {}; expected 0 to 2", kind));
  return {.name = state[0].cast<std::string>(),
          .node = state[1].cast<std::optional<long long>>(),
          .direction = state[2].cast<Eigen::Vector3d>(),
          .position = state[3].cast<std::optional<Eigen::Vector3d>>(),
          .unit = state[4].cast<std::string>(),
          .kind = static_cast<modal::FrfKind>(kind)};
}

py::tuple state_of(const io::FrfFile& file) {
  const auto& set = file.set;
  return py::make_tuple(file.format, file.notes, set.outputs, set.inputs, set.frequency_hz,
                        array_of<Complexes>(set.value, set.output_count(), set.input_count()),
                        array_or_none<Numbers>(set.variance, set),
                        array_or_none<Numbers>(set.noise_variance, set),
                        array_or_none<Numbers>(set.coherence, set), set.averages);
}

std::shared_ptr<io::FrfFile> frf_of(const py::tuple& state) {
  require_size(state, 10);
  modal::FrfSet set;
  set.outputs = state[2].cast<std::vector<MeasuredChannel>>();
  set.inputs = state[3].cast<std::vector<MeasuredChannel>>();
  set.frequency_hz = state[4].cast<Eigen::VectorXd>();
  set.value =
      matrices_of<Eigen::MatrixXcd>(array_in<Complexes>(state[5], "a copied array"),
                                    "a copied array", set.output_count(), set.input_count());
  set.variance = lines_in(state[6], set);
  set.noise_variance = lines_in(state[7], set);
  set.coherence = lines_in(state[8], set);
  set.averages = state[9].cast<double>();
  modal::check(set);
  return std::make_shared<io::FrfFile>(io::FrfFile{state[0].cast<std::string>(), std::move(set),
                                                   state[1].cast<std::vector<std::string>>()});
}

py::tuple state_of(const modal::ControlModel& model) {
  const auto& space = model.space;
  return py::make_tuple(space.a, space.b, space.c, space.d, space.sample_time_s, told(model.states),
                        told(model.inputs), told(model.outputs), model.input_delay,
                        model.output_delay);
}

modal::ControlModel control_model_of(const py::tuple& state) {
  require_size(state, 10);
  const auto matrix = [&](std::size_t part) { return state[part].cast<Eigen::MatrixXd>(); };
  modal::ControlModel model;
  model.space = {.a = matrix(0),
                 .b = matrix(1),
                 .c = matrix(2),
                 .d = matrix(3),
                 .sample_time_s = state[4].cast<double>()};
  model.states = signals_in(state[5]);
  model.inputs = signals_in(state[6]);
  model.outputs = signals_in(state[7]);
  model.input_delay = state[8].cast<Eigen::VectorXd>();
  model.output_delay = state[9].cast<Eigen::VectorXd>();
  modal::check(model);
  return model;
}

// With a function of its own for __new__, Python refuses a call of the one that is inherited, while
// the class itself makes objects as before.
void refuse_empty_objects(const py::module_& module) {
  for (const auto& [name, value] : module.attr("__dict__").cast<py::dict>()) {
    if (!PyType_Check(value.ptr())) continue;
    auto* type = reinterpret_cast<PyTypeObject*>(value.ptr());
    if (type->tp_new == py::detail::pybind11_object_new) type->tp_new = &new_object;
  }
}

}  // namespace chladni::python
