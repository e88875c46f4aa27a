#include "diagnosis/modes/given.h"

#include <algorithm>

#include "base/error.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

// Rows of the measurement in the order of the structure's channels, and those channels.
struct Shared {
  std::vector<Index> measured, structure;
};

Shared shared(const std::vector<std::string>& measured, const std::vector<std::string>& structure,
              std::vector<std::string>& notes) {
  Shared rows;
  for (std::size_t i = 0; i < structure.size(); ++i) {
    const auto found = std::ranges::find(measured, structure[i]);
    if (found == measured.end()) continue;
    rows.measured.push_back(found - measured.begin());
    rows.structure.push_back(static_cast<Index>(i));
  }
  for (const auto& name : measured) {
    if (std::ranges::find(structure, name) == structure.end()) {
      notes.push_back(name + " was measured, but the study has no such channel: left out");
    }
  }
  return rows;
}

}  // namespace

Given given(const Structure& structure, const MeasuredModes& measured) {
  check(structure);
  check(measured);
  Given result{structure, measured, {}};
  const auto out = shared(measured.outputs, structure.outputs.names, result.notes);
  const auto in = shared(measured.inputs, structure.inputs.names, result.notes);
  require(measured.outputs.empty() || !out.measured.empty(),
          "no sensor in common: the measured modes and the study name other sensors");
  auto& own = result.structure;
  own.outputs = part_of(structure.outputs, out.structure);
  own.inputs = part_of(structure.inputs, in.structure);
  own.residual = structure.residual(out.structure, in.structure);
  auto& modes = result.measured;
  modes.outputs = own.outputs.names;
  modes.inputs = own.inputs.names;
  modes.output_shapes = measured.output_shapes(out.measured, Eigen::all);
  modes.output_std = measured.output_std(out.measured, Eigen::all);
  modes.input_shapes = measured.input_shapes(in.measured, Eigen::all);
  modes.input_std = measured.input_std(in.measured, Eigen::all);
  return result;
}

}  // namespace chladni::diagnosis
