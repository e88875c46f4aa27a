// Measured mode shapes of a universal file: motions of nodes.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace chladni::io {

/// A mode with the motion of nodes along x, y and z, all in one unit that is not stated.
struct NodeShape {
  int dataset = 55;                                ///< or 2414
  double frequency_hz = 0.0, damping_ratio = 0.0;  ///< ratio 0: not stated
  std::map<long long, Eigen::Vector3cd> motion;    ///< by the node's number
};

struct NodeShapes {
  Eigen::Index nodes = 0, trace_lines = 0, elements = 0;  ///< of the geometry
  std::vector<NodeShape> modes;                           ///< in the order of the file
  std::vector<std::string> notes;
};

/// The file is sound, and holds no mode shape.
class NoShapes : public InvalidInput {
 public:
  using InvalidInput::InvalidInput;
};

/// Modes of datasets 55 and 2414: normal modes and complex eigenvalues.
/// @throws InvalidInput  as parse_uff; the displacements of a node have a coordinate system of
/// their
///                       own
/// @throws NoShapes      there is no such dataset
[[nodiscard]] NodeShapes parse_node_shapes(std::string_view bytes, const std::string& name);

/// Reads a file. @throws InvalidInput  as parse_node_shapes, or the file cannot be read
[[nodiscard]] NodeShapes read_node_shapes(const std::filesystem::path& file);

/// Whether it has an ending of universal files.
[[nodiscard]] bool is_universal_file(const std::filesystem::path& file);

/// The direction of a channel called as a node with an axis: "101z", "-101z"; zero: it is not.
[[nodiscard]] Eigen::Vector3d direction_in(std::string_view name, long long node);

}  // namespace chladni::io
