// Modes of the identified.json of `chladni identify`.
#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include "base/error.h"
#include "host/atomic_file.h"
#include "io/json.h"
#include "io/scan.h"
#include "steps/measured/modes_of_files.h"

namespace chladni::steps {
namespace {

using Eigen::Index;

constexpr std::size_t kLargestFile = std::size_t{1} << 28U;

// A number; infinite where the file has null: not measured.
double number_or_none(const io::Json& json) {
  if (std::holds_alternative<std::monostate>(json.value())) {
    return std::numeric_limits<double>::infinity();
  }
  return json.number();
}

Eigen::MatrixXd matrix(const io::Json& json, Index rows, Index cols, const std::string& what) {
  const auto& lines = json.array();
  require(static_cast<Index>(lines.size()) == rows, what + ": not one row each");
  Eigen::MatrixXd values(rows, cols);
  for (Index i = 0; i < rows; ++i) {
    const auto& line = lines[static_cast<std::size_t>(i)].array();
    require(static_cast<Index>(line.size()) == cols, what + ": not one column each");
    for (Index j = 0; j < cols; ++j) {
      values(i, j) = number_or_none(line[static_cast<std::size_t>(j)]);
    }
  }
  return values;
}

std::vector<std::string> texts(const io::Json& json) {
  std::vector<std::string> result;
  for (const auto& one : json.array()) result.push_back(one.string());
  return result;
}

void read_modes(const io::Json& json, identification::ModalFit& fit) {
  const auto& modes = json.at("modes").array();
  const auto m = static_cast<Index>(modes.size());
  for (auto* vector : {&fit.model.frequency_hz, &fit.model.damping_ratio, &fit.frequency_std_hz,
                       &fit.damping_std}) {
    vector->resize(m);
  }
  for (Index k = 0; k < m; ++k) {
    const auto& one = modes[static_cast<std::size_t>(k)];
    fit.model.frequency_hz(k) = one.at("frequency_hz").number();
    fit.model.damping_ratio(k) = number_or_none(one.at("damping_ratio"));
    fit.frequency_std_hz(k) = number_or_none(one.at("frequency_std_hz"));
    fit.damping_std(k) = number_or_none(one.at("damping_std"));
    if (fit.model.frequency_hz(k) == 0.0) ++fit.model.rigid_count;
  }
}

diagnosis::MeasuredModes modes_in(const io::Json& json) {
  const auto outputs = texts(json.at("sensors"));
  const auto inputs = texts(json.at("actuators"));
  const auto p = static_cast<Index>(outputs.size());
  const auto q = static_cast<Index>(inputs.size());
  identification::ModalFit fit;
  read_modes(json, fit);
  const Index m = fit.model.frequency_hz.size();
  fit.model.output_shapes = matrix(json.at("output_matrix"), p, m, "output_matrix");
  fit.model.input_shapes = matrix(json.at("input_matrix"), m, q, "input_matrix");
  fit.output_std = matrix(json.at("output_std"), p, m, "output_std");
  fit.input_std = matrix(json.at("input_std"), m, q, "input_std");
  auto modes =
      diagnosis::measured_modes(fit, outputs, inputs, 0.0, std::numeric_limits<double>::infinity());
  const bool is_real = json.at("damping").string() == "modal";
  modes.scaled = is_real;  // real parts alone do not give a residue
  return modes;
}

void require_channels(const std::vector<std::string>& names,
                      const std::vector<study::Channel>& channels, const std::string& file,
                      const std::string& side) {
  const bool any = std::ranges::any_of(names, [&](const std::string& name) {
    return std::ranges::any_of(channels,
                               [&](const study::Channel& one) { return one.name == name; });
  });
  require(any,
          file + ": no " + side + " of the study is among those of the file, " + io::listed(names));
}

}  // namespace

diagnosis::MeasuredModes modes_of_identified(const study::Study& study) {
  const auto& path = study.measurement->modes_file;
  diagnosis::MeasuredModes modes;
  try {
    modes = modes_in(io::parse_json(read_whole(path, kLargestFile)));
  } catch (const InvalidInput& e) {
    throw InvalidInput(path.string() + ": " + e.what() +
                       "; expected the identified.json of chladni identify");
  }
  require(modes.count() > 0, path.string() + ": no mode that the data support");
  require_channels(modes.outputs, study.sensors, path.string(), "sensor");
  require_channels(modes.inputs, study.actuators, path.string(), "actuator");
  return modes;
}

}  // namespace chladni::steps
