// Mode shapes at nodes as a universal file, with the geometry that other programs draw them on.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "base/arrays.h"

namespace chladni::io {

/// m modes at n nodes.
struct UffModes {
  std::string title;            ///< model's name, and the first line of each shape
  std::string program;          ///< "chladni 0.1.0+g0123456789"
  std::vector<long long> node;  ///< n numbers, 1 to 2147483647, each once
  Points place;                 ///< n×3 [m]
  Cells triangles;              ///< t×3, rows of `place`; empty: no surface
  std::vector<std::array<Eigen::Index, 2>> lines;  ///< of a wire frame: rows of `place`
  Eigen::VectorXd frequency_hz, damping_ratio;     ///< m; a frequency of 0 is a rigid-body mode
  Eigen::MatrixXd shapes;                          ///< 3n×m: x0 y0 z0 x1 ...
  Eigen::MatrixXd imaginary;                       ///< of complex shapes; empty: real ones
  /// m: true where the shape is mass-normalised [kg^-1/2] (a complex one: in the scale of
  /// identification::ComplexShapes); false: its scale is not known.
  std::vector<bool> has_scale;
  /// n×m: false where the motion of a node is not known: the mode has no record of it, and a mode
  /// of no known node has no dataset. Empty: all are known.
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> known;
};

/// The dataset of the shapes: 55 of test programs, or 2414 of finite-element programs.
enum class ShapeDataset { nodes_55, analysis_2414 };

/// A file of the datasets 151, 164 (SI), the nodes, what joins them, and one dataset per mode. The
/// nodes of a surface are 2411 and its triangles 2412 (descriptor 91, thin shell, linear); the
/// nodes of a wire frame are 15 and its lines 82. Numbers of 13 columns have all digits that fit.
/// The modal mass is 1, or 0 for an unknown scale; of complex shapes, modal A is 2jω√(1−ζ²) and
/// modal B −λ times it, or 0. Cost: linear.
/// @throws InvalidInput  sizes do not fit together, a node number occurs twice or is out of range
[[nodiscard]] std::string modes_uff(const UffModes& modes, ShapeDataset dataset);

/// The lines of the shortest tree that joins all places (Prim 1957): a wire frame for the eye. Of
/// equal lines the one of the lower rows is taken. Cost: n².
[[nodiscard]] std::vector<std::array<Eigen::Index, 2>> wire_frame(const Points& place);

}  // namespace chladni::io
