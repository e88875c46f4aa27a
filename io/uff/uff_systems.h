// Coordinate systems of a universal file: what directions and places at its nodes mean.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "io/uff/uff.h"
#include "io/uff/uff_lines.h"
#include "modal/frf_set.h"

namespace chladni::io {

/// Datasets 18 and 2420 into `systems`. `lines` is behind the line with the number, afterwards
/// before the closing -1. Two systems of one number that differ are kept as a fault.
/// @throws InvalidInput  a record is missing or no number
void read_systems_of_18(UffLines& lines, std::map<long long, UffSystem>& systems);
void read_systems_of_2420(UffLines& lines, std::map<long long, UffSystem>& systems);

/// The systems of a file in its global frame. The file must outlive it.
///
/// Number 0 is the global frame, and so is number 1 in files that define no system. Cartesian and
/// cylindrical ones (radius, angle in degrees, height) are known. A system of dataset 2420 has its
/// axes in the rows of the matrix and its origin in the fourth row, as its 4×3 numbers say: places
/// are rows, [x y z 1] times the matrix.
class UffFrames {
 public:
  explicit UffFrames(const Uff& uff) : uff_(uff) {}

  /// The node's place in the global frame, in the file's unit of length.
  /// @throws InvalidInput  its system is not known: says which and why
  [[nodiscard]] Eigen::Vector3d place(long long node) const;
  /// What is called x, y, z (or r, θ, z) at the node as columns, in the global frame.
  /// @throws InvalidInput  as place; a cylinder's radius has no direction on its axis
  [[nodiscard]] Eigen::Matrix3d axes(long long node) const;

 private:
  struct Frame {
    int type = 0;
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  };

  [[nodiscard]] Frame frame(long long number, std::size_t depth = 0) const;
  [[nodiscard]] static Eigen::Vector3d place_in(const Frame& frame, const Eigen::Vector3d& at);
  [[nodiscard]] UffNodeSystems systems_of(long long node) const;

  const Uff& uff_;
};

/// Directions of channels into the global frame, and their places from the file's nodes. A
/// direction or place whose system is not known is taken away; `notes` get what was turned and what
/// was taken away. @param length  metres per unit of the file; none: places are not known
void place_channels(const Uff& uff, std::optional<double> length,
                    std::vector<modal::MeasuredChannel>& channels, std::vector<std::string>& notes);

}  // namespace chladni::io
