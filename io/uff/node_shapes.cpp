#include "io/node_shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/error.h"
#include "host/atomic_file.h"
#include "io/measured/measured_format.h"
#include "io/uff/uff.h"
#include "io/uff/uff_channels.h"
#include "io/uff/uff_systems.h"

namespace chladni::io {
namespace {

constexpr std::array kModal = {2, 3, 7};    // analyses: normal modes, complex eigenvalues
constexpr std::size_t kMemoryPerByte = 16;  // for the numbers of a shape and its nodes
constexpr std::array kAxes = {1, 2, 3, -1, -2, -3};

bool is_mode(const UffShape& shape) {
  return std::ranges::find(kModal, shape.analysis) != kModal.end() && shape.values.cols() >= 3;
}

// Whether the axes of a node are those of the global frame, by whatever number.
bool are_global(const UffFrames& frames, long long node) {
  try {
    return frames.axes(node).isIdentity(1e-9);
  } catch (const InvalidInput&) {
    return false;
  }
}

void refuse_own_systems(const Uff& uff, const UffShape& shape, const std::string& name) {
  const UffFrames frames(uff);
  for (const auto node : shape.nodes) {
    const auto found = uff.node_systems.find(node);
    if (found == uff.node_systems.end() || are_global(frames, node)) continue;
    throw InvalidInput(name + ": line " + fmt::to_string(shape.line) +
                       ": the displacements of node " + fmt::to_string(node) +
                       " have the coordinate system " + fmt::to_string(found->second.displacement) +
                       "; expected the global one");
  }
}

NodeShape mode_of(const UffShape& shape) {
  NodeShape mode{shape.dataset, shape.frequency_hz, shape.damping_ratio, {}};
  for (std::size_t n = 0; n < shape.nodes.size(); ++n) {
    const auto row = static_cast<Eigen::Index>(n);
    mode.motion.emplace(shape.nodes[n], shape.values.row(row).head(3).transpose());
  }
  return mode;
}

}  // namespace

NodeShapes parse_node_shapes(std::string_view bytes, const std::string& name) {
  const Uff uff = parse_uff(bytes, name);
  NodeShapes result{.nodes = static_cast<Eigen::Index>(uff.nodes.size()),
                    .trace_lines = static_cast<Eigen::Index>(uff.trace_lines.size()),
                    .elements = static_cast<Eigen::Index>(uff.elements.size()),
                    .modes = {},
                    .notes = uff.notes};
  for (const auto& shape : uff.shapes) {
    if (!is_mode(shape)) continue;
    refuse_own_systems(uff, shape, name);
    result.modes.push_back(mode_of(shape));
  }
  if (result.modes.empty()) {
    throw NoShapes(name +
                   ": no mode shape; expected datasets 55 or 2414 of normal modes or complex "
                   "eigenvalues");
  }
  return result;
}

NodeShapes read_node_shapes(const std::filesystem::path& file) {
  return parse_node_shapes(read_whole(file, reading_limit() / kMemoryPerByte), file.string());
}

bool is_universal_file(const std::filesystem::path& file) {
  return measured_format(file) == MeasuredFormat::uff;
}

Eigen::Vector3d direction_in(std::string_view name, long long node) {
  for (const int axis : kAxes) {
    if (name == name_of(UffDof{{}, node, axis})) return vector_of(axis);
  }
  return Eigen::Vector3d::Zero();
}

}  // namespace chladni::io
