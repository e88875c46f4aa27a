// Files of measured responses and recordings from Python.
#include <fmt/format.h>
#include <pybind11/complex.h>
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "base/error.h"
#include "identification/delay.h"
#include "io/frf_file.h"
#include "io/measured_units.h"
#include "io/time_file.h"
#include "python/calls/long_call.h"
#include "python/rooms.h"
#include "python/values/copies.h"
#include "python/values/frf_arrays.h"
#include "python/values/given.h"
#include "recordings/frf_estimate.h"
#include "steps/identification.h"

namespace chladni::python {
namespace {

namespace py = pybind11;
using io::FrfFile;
using io::TimeFile;
using modal::MeasuredChannel;
using Names = std::vector<std::string>;
using FrfClass = py::class_<FrfFile, std::shared_ptr<FrfFile>>;

constexpr const char* kQuantities[] = {"displacement", "velocity", "acceleration"};

const char* quantity_of(modal::FrfKind kind) { return kQuantities[static_cast<int>(kind)]; }

modal::FrfKind kind_called(const std::string& quantity) {
  for (const auto kind :
       {modal::FrfKind::receptance, modal::FrfKind::mobility, modal::FrfKind::accelerance}) {
    if (quantity == quantity_of(kind)) return kind;
  }
  throw InvalidInput("the quantity \"" + quantity +
                     "\" is not known; expected displacement, velocity or acceleration");
}

// Arrays beside a unit of motion, force or response are in SI, and all that is done with them
// counts on it.
void require_si(const std::string& unit, modal::FrfKind kind) {
  const auto require_one = [&](double factor, const std::string& si, const std::string& more) {
    require(std::abs(factor - 1.0) < 1e-12,
            fmt::format("the unit \"{}\" is not SI; give values in {}{}", unit, si, more));
  };
  const auto response = io::response_per_newton(unit);
  const auto motion = response ? response : io::motion_unit(io::bare_unit(unit));
  if (!motion) return require_one(io::force_unit(unit).value_or(1.0), "N", "");
  const auto stated = motion->kind.value_or(kind);
  const std::string quantity = quantity_of(stated);
  require_one(motion->factor, motion->si + (response ? "/N" : ""),
              fmt::format(", and quantity=\"{}\"", quantity));
  require(stated == kind, fmt::format("the unit \"{}\" is none of a {}; expected quantity=\"{}\"",
                                      unit, quantity_of(kind), quantity));
}

MeasuredChannel channel_with(const std::string& name, const std::string& quantity,
                             const std::string& unit,
                             const std::optional<Given<"position", Eigen::Vector3d>>& position,
                             const std::optional<Given<"direction", Eigen::Vector3d>>& direction,
                             std::optional<long long> node) {
  require_si(unit, kind_called(quantity));
  MeasuredChannel channel{
      .name = name, .node = node, .position = {}, .unit = unit, .kind = kind_called(quantity)};
  if (position) channel.position = position->value;
  if (direction) channel.direction = direction->value;
  return channel;
}

// Channels, or names of such, in anything that has some one after the other.
std::vector<MeasuredChannel> channels_from(const py::object& given, const std::string& side) {
  require(!py::isinstance<py::str>(given) && py::isinstance<py::iterable>(given),
          side + " is " + shown(given) + "; expected a list of Channels or names");
  std::vector<MeasuredChannel> channels;
  for (const auto& one : given) {
    py::detail::make_caster<std::string> name;
    if (py::isinstance<MeasuredChannel>(one)) {
      channels.push_back(one.cast<MeasuredChannel>());
    } else if (py::isinstance<py::str>(one) && name.load(one, true)) {
      channels.push_back({.name = py::detail::cast_op<std::string>(name)});
    } else {
      throw InvalidInput(side + " has " + shown(one) + "; expected a Channel or a name");
    }
  }
  return channels;
}

std::shared_ptr<FrfFile> responses_with(std::string format, modal::FrfSet set,
                                        std::vector<std::string> notes) {
  modal::check(set);
  return std::make_shared<FrfFile>(FrfFile{std::move(format), std::move(set), std::move(notes)});
}

std::shared_ptr<FrfFile> frf_with(const Given<"frequency_hz", Eigen::VectorXd>& frequency_hz,
                                  const py::object& given, const py::object& outputs,
                                  const py::object& inputs,
                                  const std::optional<Given<"variance", Numbers>>& variance,
                                  const std::optional<Given<"coherence", Numbers>>& coherence,
                                  double averages) {
  const auto value = array_in<Complexes>(given, "value");
  modal::FrfSet set;
  set.outputs = channels_from(outputs, "outputs");
  set.inputs = channels_from(inputs, "inputs");
  set.frequency_hz = frequency_hz.value;
  const auto p = set.output_count();
  const auto q = set.input_count();
  set.value = matrices_of<Eigen::MatrixXcd>(value, "value", p, q);
  if (variance) set.variance = matrices_of<Eigen::MatrixXd>(variance->value, "variance", p, q);
  if (coherence) set.coherence = matrices_of<Eigen::MatrixXd>(coherence->value, "coherence", p, q);
  set.averages = averages;
  auto made = responses_with("arrays", std::move(set), {});
  require_phase(given, "value");
  return made;
}

std::shared_ptr<FrfFile> changed(const FrfFile& file, modal::FrfSet set) {
  return responses_with(file.format, std::move(set), file.notes);
}

std::shared_ptr<FrfFile> converted(const FrfFile& file, const std::string& quantity) {
  auto result = changed(file, modal::converted(file.set, kind_called(quantity)));
  if (result->set.line_count() < file.set.line_count()) {
    result->notes.emplace_back("the line at 0 Hz is left out: it cannot be integrated");
  }
  return result;
}

// "SI" says the unit of what a channel measures, and not what that is.
void require_quantities(const std::filesystem::path& file, const std::string& unit,
                        const std::vector<MeasuredChannel>& outputs, const std::string& else_say) {
  if (unit != io::kEachInSi) return;
  for (const auto& one : outputs) {
    require(!one.unit.empty(),
            fmt::format("{}: unit=\"SI\": the file does not say what \"{}\" measures; expected {}",
                        file.string(), one.name, else_say));
  }
}

// The responses of recordings.
// @param inputs  what they are, as the key of [measurement] says it
std::shared_ptr<FrfFile> estimated(const TimeFile& file, double low_hz, double high_hz,
                                   const std::string& inputs) {
  require(inputs == "commands" || inputs == "forces",
          "inputs is \"" + inputs + "\"; expected \"commands\", which are held from sample to " +
              "sample, or \"forces\", which were measured");
  constexpr double kAll = std::numeric_limits<double>::infinity();
  require_band(low_hz, high_hz == 0.0 ? kAll : high_hz);
  const LongCall call;
  auto found = recordings::frf_estimate(
      file.data, {.drop = {}, .low_hz = low_hz, .high_hz = high_hz, .smooth_lines = {}});
  if (inputs == "commands") {
    found.set = identification::without_delay(found.set, 0.0, file.data.sample_time_s);
    found.notes.emplace_back(
        "the hold of the commands is taken off; inputs=\"forces\" leaves it in");
  }
  return responses_with(file.format, std::move(found.set), std::move(found.notes));
}

std::vector<Eigen::Index> rows_called(const std::vector<MeasuredChannel>& channels,
                                      const std::optional<Names>& names) {
  std::vector<Eigen::Index> rows;
  if (!names) {
    for (Eigen::Index i = 0; i < std::ssize(channels); ++i) rows.push_back(i);
    return rows;
  }
  for (const auto& name : *names) {
    rows.push_back(steps::index_of(channels, name));
    require(rows.back() >= 0, "there is no channel \"" + name + "\"");
  }
  return rows;
}

std::shared_ptr<FrfFile> read_frf(const std::filesystem::path& file, const std::string& unit,
                                  const std::optional<std::string>& quantity, const Names& sensors,
                                  const Names& actuators, const std::string& length_unit) {
  io::FrfOptions options;
  options.unit = unit;
  options.sensor_names = sensors;
  options.actuator_names = actuators;
  options.length_unit = length_unit;
  if (quantity) options.kind = kind_called(*quantity);
  const LongCall call;
  auto read = std::make_shared<FrfFile>(io::read_frf(file, options));
  require_quantities(file, unit, read->set.outputs,
                     "a unit such as \"m/s^2\", a quantity, or a study that reads the file");
  return read;
}

std::shared_ptr<TimeFile> read_time(const std::filesystem::path& file, const std::string& unit,
                                    double sample_time_s, Eigen::Index period, const Names& sensors,
                                    const Names& actuators) {
  io::TimeOptions options;
  options.unit = unit;
  options.sample_time_s = sample_time_s;
  options.period = period;
  options.sensor_names = sensors;
  options.actuator_names = actuators;
  const LongCall call;
  auto read = std::make_shared<TimeFile>(io::read_time(file, options));
  require_quantities(file, unit, read->data.outputs,
                     "a unit such as \"m/s^2\", or a study that reads the file");
  return read;
}

// What the format cannot hold.
template <typename Write>
Names written(const std::filesystem::path& file, bool overwrite, Write write) {
  const LongCall call;
  std::error_code fault;
  require(overwrite || !std::filesystem::exists(file, fault),
          file.string() + ": there is such a file; name another one, or give overwrite=True");
  return write();
}

std::string frf_text(const FrfFile& file) {
  const auto& set = file.set;
  return fmt::format("<chladni.Frf {} outputs, {} inputs, {} lines, {}>", set.outputs.size(),
                     set.inputs.size(), set.line_count(), file.format);
}

std::string channel_text(const MeasuredChannel& one) {
  return fmt::format("<chladni.Channel \"{}\" [{}]>", one.name, one.unit.empty() ? "?" : one.unit);
}

void add_channel(py::module_& module) {
  py::class_<MeasuredChannel>(module, "Channel", "One end of a response.")
      .def(py::init(&channel_with), py::arg("name"), py::arg("quantity") = "displacement",
           py::arg("unit") = "", py::arg("position") = py::none(),
           py::arg("direction") = py::none(), py::arg("node") = py::none(),
           "quantity of an output; unit \"\": not stated; position [m], direction (unit).")
      .def_readonly("name", &MeasuredChannel::name)
      .def_readonly("unit", &MeasuredChannel::unit, "empty: not stated")
      .def_readonly("node", &MeasuredChannel::node, "its number in a universal file, or None")
      .def_readonly("position", &MeasuredChannel::position, "[m], or None")
      .def_property_readonly(
          "direction",
          [](const MeasuredChannel& one) -> std::optional<Eigen::Vector3d> {
            if (one.direction.isZero()) return std::nullopt;
            return one.direction;
          },
          "unit vector, or None")
      .def_property_readonly("quantity",
                             [](const MeasuredChannel& one) { return quantity_of(one.kind); })
      .def("_state", [](const MeasuredChannel& one) { return state_of(one); })
      .def_static("_of_state", &channel_of)
      .def("__repr__", &channel_text);
}

void add_frf_arrays(FrfClass& bound) {
  bound
      .def(py::init(&frf_with), py::arg("frequency_hz"), py::arg("value"), py::arg("outputs"),
           py::arg("inputs"), py::kw_only(), py::arg("variance") = py::none(),
           py::arg("coherence") = py::none(), py::arg("averages") = 0.0,
           "nan where nothing was measured; outputs and inputs are Channels, or names. variance: "
           "E|G - G0|^2.")
      .def_property_readonly(
          "frequency_hz", [](const FrfFile& f) -> const auto& { return f.set.frequency_hz; })
      .def_property_readonly(
          "value",
          [](const FrfFile& f) {
            return array_of<Complexes>(f.set.value, f.set.output_count(), f.set.input_count());
          },
          "a copy, complex")
      .def_property_readonly(
          "variance",
          [](const FrfFile& f) { return array_or_none<Numbers>(f.set.variance, f.set); },
          "a copy, or None")
      .def_property_readonly(
          "coherence",
          [](const FrfFile& f) { return array_or_none<Numbers>(f.set.coherence, f.set); },
          "a copy, or None")
      .def_property_readonly("outputs", [](const FrfFile& f) { return f.set.outputs; })
      .def_property_readonly("inputs", [](const FrfFile& f) { return f.set.inputs; })
      .def_property_readonly("averages", [](const FrfFile& f) { return f.set.averages; })
      .def_readonly("format", &FrfFile::format)
      .def_readonly("notes", &FrfFile::notes, "what was assumed, skipped or suspicious");
}

void add_frf(py::module_& module) {
  FrfClass bound(module, "Frf",
                 "Frequency responses, each lines x outputs x inputs, with e^{+jwt}.");
  add_frf_arrays(bound);
  bound
      .def("converted", &converted, py::arg("quantity"),
           "Every output as displacement, velocity or acceleration. A line at 0 Hz that cannot be "
           "integrated is left out; a note says so.")
      .def(
          "band",
          [](const FrfFile& f, double low_hz, double high_hz) {
            require_band(low_hz, high_hz);
            return changed(f, modal::band(f.set, low_hz, high_hz));
          },
          py::arg("low_hz"), py::arg("high_hz"))
      .def(
          "part",
          [](const FrfFile& f, const std::optional<Names>& outputs,
             const std::optional<Names>& inputs) {
            return changed(f, modal::part(f.set, rows_called(f.set.outputs, outputs),
                                          rows_called(f.set.inputs, inputs)));
          },
          py::arg("outputs") = py::none(), py::arg("inputs") = py::none(),
          "Channels of these names, in this order.")
      .def("_state", [](const FrfFile& f) { return state_of(f); })
      .def_static("_of_state", &frf_of)
      .def("__repr__", &frf_text);
}

void add_recordings(py::module_& module) {
  using recordings::Record;
  py::class_<Record>(module, "Record", "One recording of N samples. Arrays are views.")
      .def_readonly("outputs", &Record::outputs, "N x p")
      .def_readonly("inputs", &Record::inputs, "N x q")
      .def_readonly("references", &Record::references, "N x r")
      .def_readonly("experiment", &Record::experiment)
      .def_readonly("realisation", &Record::realisation);
  py::class_<TimeFile, std::shared_ptr<TimeFile>>(module, "Recordings", "Samples over time.")
      .def_property_readonly("outputs", [](const TimeFile& t) { return t.data.outputs; })
      .def_property_readonly("inputs", [](const TimeFile& t) { return t.data.inputs; })
      .def_property_readonly("references", [](const TimeFile& t) { return t.data.references; })
      .def_property_readonly("sample_time_s",
                             [](const TimeFile& t) { return t.data.sample_time_s; })
      .def_property_readonly(
          "period", [](const TimeFile& t) { return t.data.period; },
          "[samples] of a periodic excitation; 0: none")
      .def_property_readonly(
          "records",
          [](const py::object& self) {
            py::list records;
            for (const auto& one : self.cast<const TimeFile&>().data.records) {
              records.append(py::cast(one, py::return_value_policy::reference_internal, self));
            }
            return records;
          })
      .def_readonly("format", &TimeFile::format)
      .def_readonly("notes", &TimeFile::notes)
      .def("frf", &estimated, py::arg("low_hz") = 0.0, py::arg("high_hz") = 0.0, py::kw_only(),
           py::arg("inputs") = "commands",
           "Responses with variances, of a periodic excitation in open loop; high_hz 0: all "
           "excited lines. inputs: \"commands\", whose hold from sample to sample is taken off, or "
           "measured \"forces\".");
}

void add_functions(py::module_& module) {
  module.def("read_frf", &read_frf, py::arg("file"), py::kw_only(), py::arg("unit") = "",
             py::arg("quantity") = py::none(), py::arg("sensors") = Names{},
             py::arg("actuators") = Names{}, py::arg("length_unit") = "",
             "Responses of a .csv, .csv.gz, .uff, .unv or .mat, in SI. unit and quantity where the "
             "file states none; names of channels help to divide those of columns.");
  module.def(
      "write_frf",
      [](const std::filesystem::path& file, const FrfFile& frf, bool overwrite) {
        return written(file, overwrite, [&] { return io::write_frf(file, frf.set); });
      },
      py::arg("file"), py::arg("frf"), py::kw_only(), py::arg("overwrite") = false,
      "Writes .csv, .uff, .unv or .mat, and tells what the format cannot hold.");
  module.def("read_time", &read_time, py::arg("file"), py::kw_only(), py::arg("unit") = "",
             py::arg("sample_time_s") = 0.0, py::arg("period") = 0, py::arg("sensors") = Names{},
             py::arg("actuators") = Names{}, "Recordings of a .csv, .uff, .unv or .mat, in SI.");
  module.def(
      "write_time",
      [](const std::filesystem::path& file, const TimeFile& recordings, bool overwrite) {
        return written(file, overwrite, [&] { return io::write_time(file, recordings.data); });
      },
      py::arg("file"), py::arg("recordings"), py::kw_only(), py::arg("overwrite") = false,
      "Writes .csv, .uff, .unv or .mat, and tells what the format cannot hold.");
}

}  // namespace

void add_files(py::module_& module) {
  add_channel(module);
  add_frf(module);
  add_recordings(module);
  add_functions(module);
}

}  // namespace chladni::python
