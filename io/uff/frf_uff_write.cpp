// Writes measured responses to a universal file.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "io/measured/frf_units.h"
#include "io/scan.h"
#include "io/uff/frf_uff.h"
#include "io/uff/uff_channels.h"

namespace chladni::io {
namespace {

using Index = Eigen::Index;

void require_name(const modal::MeasuredChannel& channel) {
  const auto& name = channel.name;
  require(name.size() <= 60 && name.find_first_of("\r\n") == std::string_view::npos &&
              trimmed(name) == name,
          "UFF cannot hold the channel name " + shown(name) +
              "; expected at most 60 letters without line ends and blanks around them");
}

UffAxis axis_of(int type, const char* label, const std::string& unit) {
  UffAxis axis;
  axis.type = type;
  axis.label = label;
  axis.unit = unit;
  return axis;
}

// The axis of an output. An output without a unit must not get one from dataset 164, so its type is
// left open and the label states the kind.
UffAxis motion_axis(const modal::MeasuredChannel& channel) {
  constexpr std::array<int, 3> types{8, 11, 12};
  constexpr std::array<const char*, 3> labels{"Displacement", "Velocity", "Acceleration"};
  const auto kind = static_cast<std::size_t>(channel.kind);
  const bool stated = motion_unit(channel.unit).has_value();
  UffAxis axis = axis_of(stated ? types[kind] : 0, labels[kind], channel.unit);
  axis.length_exponent = stated ? 1 : 0;
  return axis;
}

UffAxis force_axis(const modal::MeasuredChannel& channel) {
  const bool stated = force_unit(channel.unit).has_value();
  UffAxis axis = axis_of(stated ? 13 : 0, "Excitation", channel.unit);
  axis.force_exponent = stated ? 1 : 0;
  return axis;
}

bool is_measured(const modal::FrfSet& set, Index i, Index j) {
  return std::ranges::any_of(
      set.value, [&](const Eigen::MatrixXcd& line) { return !std::isnan(line(i, j).real()); });
}

// A channel stands in a universal file with its responses alone.
void note_unmeasured(const modal::FrfSet& set, std::vector<std::string>& lost) {
  Eigen::MatrixX<bool> measured(set.output_count(), set.input_count());
  for (Index i = 0; i < measured.rows(); ++i) {
    for (Index j = 0; j < measured.cols(); ++j) measured(i, j) = is_measured(set, i, j);
  }
  const auto note = [&](const modal::MeasuredChannel& channel) {
    lost.push_back("UFF holds no channel without a measured response: " + channel.name +
                   " is left out");
  };
  for (Index i = 0; i < measured.rows(); ++i) {
    if (!measured.row(i).any()) note(set.outputs[static_cast<std::size_t>(i)]);
  }
  for (Index j = 0; j < measured.cols(); ++j) {
    if (!measured.col(j).any()) note(set.inputs[static_cast<std::size_t>(j)]);
  }
}

// The datasets of a response and its coherence; empty where the response was not measured.
std::string pair_datasets(const modal::FrfSet& set, Index i, Index j, UffFunction function,
                          UffEncoding encoding) {
  if (!is_measured(set, i, j)) return {};
  const auto& output = set.outputs[static_cast<std::size_t>(i)];
  const auto& input = set.inputs[static_cast<std::size_t>(j)];
  function.id[3] = std::string(kResponseName) + output.name;
  function.id[4] = std::string(kReferenceName) + input.name;
  function.type = 4;
  function.is_complex = true;
  function.ordinate = motion_axis(output);
  function.denominator = force_axis(input);
  for (Index k = 0; k < set.line_count(); ++k) {
    function.y(k) = set.value[static_cast<std::size_t>(k)](i, j);
  }
  std::string text = uff_dataset(function, encoding);
  if (set.coherence.empty()) return text;
  function.type = 6;
  function.is_complex = false;
  function.ordinate = axis_of(1, "Coherence", "");
  function.denominator = {};
  for (Index k = 0; k < set.line_count(); ++k) {
    function.y(k) = set.coherence[static_cast<std::size_t>(k)](i, j);
  }
  return text + uff_dataset(function, encoding);
}

void note_variances(const modal::FrfSet& set, std::vector<std::string>& lost) {
  if (!set.variance.empty()) lost.emplace_back("UFF holds no variances: they are left out");
  if (!set.noise_variance.empty()) {
    lost.emplace_back("UFF holds no variances by noise: they are left out");
  }
  if (set.averages > 0.0) {
    lost.emplace_back("UFF holds no number of averages: it is left out");
  }
}

}  // namespace

std::string frf_uff(const modal::FrfSet& set, UffEncoding encoding,
                    std::vector<std::string>& lost) {
  modal::check(set);
  for (const auto& output : set.outputs) require_name(output);
  for (const auto& input : set.inputs) require_name(input);
  note_variances(set, lost);
  note_unmeasured(set, lost);
  const UffSides sides{&set.outputs, &set.inputs};
  const auto dofs = dofs_of(sides);
  std::string text = uff_head("measured frequency responses", places_of(sides, dofs, lost));
  UffFunction function;
  function.abscissa = axis_of(18, "Frequency", "Hz");
  function.x = set.frequency_hz;
  function.y.resize(set.line_count());
  for (Index i = 0; i < set.output_count(); ++i) {
    for (Index j = 0; j < set.input_count(); ++j) {
      function.response = dofs[0][static_cast<std::size_t>(i)];
      function.reference = dofs[1][static_cast<std::size_t>(j)];
      text += pair_datasets(set, i, j, function, encoding);
    }
  }
  return text;
}

}  // namespace chladni::io
