#include "io/node_shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <map>

#include "base/error.h"
#include "host/atomic_file.h"
#include "io/measured/measured_format.h"
#include "io/scan.h"
#include "io/uff/uff.h"
#include "io/uff/uff_channels.h"
#include "io/uff/uff_systems.h"

namespace chladni::io {
namespace {

constexpr std::array kModal = {2, 3, 7};    // analyses: normal modes, complex eigenvalues
constexpr std::size_t kMemoryPerByte = 16;  // for the numbers of a shape and its nodes
constexpr std::array kAxes = {1, 2, 3, -1, -2, -3};
constexpr double kModeRounding = 1e-5;  // of numbers with six digits

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

std::string told(const UffShape& shape) {
  return "dataset " + fmt::to_string(shape.dataset) + " from line " + fmt::to_string(shape.line);
}

// The shape of an eigenvalue in the lower half plane is the conjugate of that of its pair.
NodeShape mode_of(const UffShape& shape, const std::string& name) {
  NodeShape mode{shape.dataset, shape.frequency_hz, shape.damping_ratio, {}};
  const bool is_conjugate = shape.eigenvalue.imag() < 0.0;
  for (std::size_t n = 0; n < shape.nodes.size(); ++n) {
    const auto row = static_cast<Eigen::Index>(n);
    Eigen::Vector3cd motion = shape.values.row(row).head(3).transpose();
    if (is_conjugate) motion = motion.conjugate().eval();
    const auto [place, is_new] = mode.motion.emplace(shape.nodes[n], motion);
    require(is_new || place->second == motion, name + ": " + told(shape) + ": node " +
                                                   fmt::to_string(shape.nodes[n]) +
                                                   " has two motions that differ");
  }
  return mode;
}

void require_sound(const UffShape& shape, const std::string& name) {
  const auto refuse = [&](const std::string& what) {
    throw InvalidInput(name + ": " + told(shape) + ": " + what);
  };
  if (shape.frequency_hz < 0.0) {
    refuse(
        fmt::format("the frequency of a mode is {:g} Hz, expected 0 or more", shape.frequency_hz));
  }
  if (std::abs(shape.damping_ratio) < 1.0) return;
  refuse(fmt::format("the damping ratio is {:.6g}; expected a ratio below 1, such as 0.02 for 2 %",
                     shape.damping_ratio));
}

bool has_rotations(const UffShape& shape) {
  return !shape.values.rightCols(shape.values.cols() - 3).isZero(0.0);
}

// Whether an eigenvalue is real, of motions without oscillation.
bool is_overdamped(const UffShape& shape) {
  return shape.eigenvalue != 0.0 && std::abs(shape.damping_ratio) > 1.0 - 1e-12;
}

/// The eigenvalues of all modes by their imaginary part.
using Eigenvalues = std::multimap<double, std::complex<double>>;

Eigenvalues eigenvalues_of(const std::vector<UffShape>& shapes) {
  Eigenvalues all;
  for (const auto& shape : shapes) {
    if (is_mode(shape)) all.emplace(shape.eigenvalue.imag(), shape.eigenvalue);
  }
  return all;
}

// Whether it is the second of a pair of conjugate eigenvalues, both of which are in the file.
bool is_second_of_pair(const UffShape& shape, const Eigenvalues& all) {
  const auto value = shape.eigenvalue;
  if (!(value.imag() < 0.0)) return false;
  const double off = kModeRounding * std::abs(value);
  const auto last = all.upper_bound(-value.imag() + off);
  return std::any_of(all.lower_bound(-value.imag() - off), last, [&](const auto& other) {
    return std::abs(std::conj(other.second) - value) <= off;
  });
}

// Whether a mode is another one again, as where a file has datasets 55 and 2414 of the same modes.
bool is_copy(const NodeShape& mode, const NodeShape& other) {
  const bool is_near =
      std::abs(mode.frequency_hz - other.frequency_hz) <= kModeRounding * other.frequency_hz;
  if (!is_near || mode.motion.size() != other.motion.size()) return false;
  double size = 0.0;
  double off = 0.0;
  for (const auto& [node, motion] : mode.motion) {
    const auto found = other.motion.find(node);
    if (found == other.motion.end()) return false;
    size = std::max(size, motion.cwiseAbs().maxCoeff());
    off = std::max(off, (motion - found->second).cwiseAbs().maxCoeff());
  }
  return off <= kModeRounding * size;
}

/// The modes that were taken, by their first node and then by frequency: those that may be copies
/// of another one are near it.
class TakenModes {
 public:
  explicit TakenModes(const std::vector<NodeShape>& modes) : modes_(modes) {}

  [[nodiscard]] bool contains(const NodeShape& mode) const {
    const double off = 2.0 * kModeRounding * mode.frequency_hz;
    const auto first = places_.lower_bound({first_node(mode), mode.frequency_hz - off});
    const auto last = places_.upper_bound({first_node(mode), mode.frequency_hz + off});
    return std::any_of(first, last,
                       [&](const auto& at) { return is_copy(mode, modes_[at.second]); });
  }

  /// Adds the last one of the modes.
  void add_last() {
    const auto& mode = modes_.back();
    places_.emplace(std::pair(first_node(mode), mode.frequency_hz), modes_.size() - 1);
  }

 private:
  static long long first_node(const NodeShape& mode) {
    return mode.motion.empty() ? 0 : mode.motion.begin()->first;
  }

  const std::vector<NodeShape>& modes_;
  std::multimap<std::pair<long long, double>, std::size_t> places_;
};

/// Numbers of what is left out.
struct LeftOut {
  int pairs = 0, rotations = 0, overdamped = 0, copies = 0, still = 0;
  std::map<int, std::vector<std::string>> others;  ///< of each other analysis

  void tell(std::vector<std::string>& notes) const {
    const auto add = [&](int count, const char* what) {
      if (count > 0)
        notes.push_back(fmt::format("{} mode{} {}", count, count > 1 ? "s" : "", what));
    };
    for (const auto& [analysis, shapes] : others) {
      notes.push_back(
          fmt::format("{} {} of analysis type {}, no normal mode (2) or complex "
                      "eigenvalue (3, 7): not read",
                      listed(shapes), shapes.size() > 1 ? "are" : "is", analysis));
    }
    add(pairs, "of conjugate eigenvalues: the one above the real axis is taken");
    add(overdamped, "without oscillation (a real eigenvalue): not read");
    add(still, "whose motion is 0 at every node: not read");
    add(copies, "there again, in frequency and shape: read once");
    add(rotations, "with rotations of nodes: these are not read");
  }
};

}  // namespace

NodeShapes parse_node_shapes(std::string_view bytes, const std::string& name) {
  const Uff uff = parse_uff(bytes, name);
  NodeShapes result{.nodes = static_cast<Eigen::Index>(uff.nodes.size()),
                    .trace_lines = static_cast<Eigen::Index>(uff.trace_lines.size()),
                    .elements = static_cast<Eigen::Index>(uff.elements.size()),
                    .modes = {},
                    .notes = uff.notes};
  LeftOut left;
  const auto eigenvalues = eigenvalues_of(uff.shapes);
  TakenModes taken(result.modes);
  for (const auto& shape : uff.shapes) {
    if (!is_mode(shape)) {
      left.others[shape.analysis].push_back(told(shape));
      continue;
    }
    const bool is_second = is_second_of_pair(shape, eigenvalues);
    left.pairs += is_second ? 1 : 0;
    left.overdamped += !is_second && is_overdamped(shape) ? 1 : 0;
    if (is_second || is_overdamped(shape)) continue;
    require_sound(shape, name);
    refuse_own_systems(uff, shape, name);
    auto mode = mode_of(shape, name);
    const bool is_again = taken.contains(mode);
    const bool is_still = shape.values.isZero(0.0);
    left.still += is_still ? 1 : 0;
    left.copies += is_again && !is_still ? 1 : 0;
    if (is_again || is_still) continue;
    left.rotations += has_rotations(shape) ? 1 : 0;
    result.modes.push_back(std::move(mode));
    taken.add_last();
  }
  left.tell(result.notes);
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
