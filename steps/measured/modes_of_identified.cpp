// Modes of the identified.json of `chladni identify`.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
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
    fit.model.frequency_hz(k) = number_or_none(one.at("frequency_hz"));
    fit.model.damping_ratio(k) = number_or_none(one.at("damping_ratio"));
    fit.frequency_std_hz(k) = number_or_none(one.at("frequency_std_hz"));
    fit.damping_std(k) = number_or_none(one.at("damping_std"));
    if (fit.model.frequency_hz(k) == 0.0) ++fit.model.rigid_count;
  }
}

// What the file holds, read but not looked at.
struct IdentifiedFile {
  std::vector<std::string> outputs, inputs;
  identification::ModalFit fit;
  bool is_real = true;
};

IdentifiedFile read_identified(const io::Json& json) {
  IdentifiedFile found{texts(json.at("sensors")), texts(json.at("actuators")), {}, true};
  const auto p = static_cast<Index>(found.outputs.size());
  const auto q = static_cast<Index>(found.inputs.size());
  auto& fit = found.fit;
  read_modes(json, fit);
  const Index m = fit.model.frequency_hz.size();
  fit.model.output_shapes = matrix(json.at("output_matrix"), p, m, "output_matrix");
  fit.model.input_shapes = matrix(json.at("input_matrix"), m, q, "input_matrix");
  fit.output_std = matrix(json.at("output_std"), p, m, "output_std");
  fit.input_std = matrix(json.at("input_std"), m, q, "input_std");
  found.is_real = json.at("damping").string() == "modal";
  return found;
}

void require_different(const std::vector<std::string>& names, const std::string& side,
                       const std::string& file) {
  for (std::size_t b = 0; b < names.size(); ++b) {
    const auto a = static_cast<std::size_t>(std::ranges::find(names, names[b]) - names.begin());
    require(a == b, fmt::format("{}: {} {} and {} are both \"{}\"; expected different names", file,
                                side, a + 1, b + 1, names[b]));
  }
}

// A value or deviation that may be unknown.
void require_zero_or_more(double value, Index mode, const std::string& what,
                          const std::string& file) {
  require(value >= 0.0, fmt::format("{}: mode {}: {} is {:.6g}; expected 0 or more", file, mode + 1,
                                    what, value));
}

bool is_one_mode(const modal::ReducedModel& model, Index a, Index b) {
  return model.frequency_hz(a) == model.frequency_hz(b) &&
         model.damping_ratio(a) == model.damping_ratio(b) &&
         model.output_shapes.col(a) == model.output_shapes.col(b) &&
         model.input_shapes.row(a) == model.input_shapes.row(b);
}

void require_sound(const IdentifiedFile& found, const std::string& file) {
  require_different(found.outputs, "sensors", file);
  require_different(found.inputs, "actuators", file);
  const auto& fit = found.fit;
  for (Index k = 0; k < fit.model.frequency_hz.size(); ++k) {
    const double hz = fit.model.frequency_hz(k);
    require(std::isfinite(hz), fmt::format("{}: mode {}: frequency_hz is null; expected a number "
                                           "of Hz",
                                           file, k + 1));
    require_zero_or_more(hz, k, "frequency_hz", file);
    const double ratio = fit.model.damping_ratio(k);
    require(std::abs(ratio) < 1.0 || std::isinf(ratio),
            fmt::format("{}: mode {}: damping_ratio is {:.6g}; expected a ratio below 1, such as "
                        "0.02 for 2 %",
                        file, k + 1, ratio));
    require_zero_or_more(fit.frequency_std_hz(k), k, "frequency_std_hz", file);
    require_zero_or_more(fit.damping_std(k), k, "damping_std", file);
    for (Index j = 0; j < k; ++j) {
      require(hz == 0.0 || !is_one_mode(fit.model, j, k),
              fmt::format("{}: modes {} and {} are one: the same frequency, damping and shape; "
                          "expected each mode once",
                          file, j + 1, k + 1));
    }
  }
}

diagnosis::MeasuredModes modes_in(IdentifiedFile found) {
  auto modes =
      diagnosis::measured_modes(found.fit, std::move(found.outputs), std::move(found.inputs), 0.0,
                                std::numeric_limits<double>::infinity());
  modes.scaled = found.is_real;  // real parts alone do not give a residue
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
  IdentifiedFile found;
  try {
    found = read_identified(io::parse_json(read_whole(path, kLargestFile)));
  } catch (const InvalidInput& e) {
    throw InvalidInput(path.string() + ": " + e.what() +
                       "; expected the identified.json of chladni identify");
  }
  require_sound(found, path.string());
  const auto modes = modes_in(std::move(found));
  require(modes.count() > 0, path.string() + ": no mode that the data support");
  require_channels(modes.outputs, study.sensors, path.string(), "sensor");
  require_channels(modes.inputs, study.actuators, path.string(), "actuator");
  return modes;
}

}  // namespace chladni::steps
