// The coordinate systems of a universal file, which define directions and places at its nodes.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "io/uff/uff.h"
#include "io/uff/uff_lines.h"
#include "modal/frf_set.h"

namespace chladni::io {

/// Reads datasets 18 and 2420 into `systems`. At the start `lines` is after the line with the
/// number; at the end it is before the closing -1. Two different systems with one number become a
/// system with a fault. So does one in another unit than the nodes that is stated in a cylindrical
/// system, or in one that comes later.
/// @param length  units of length of the nodes per that of these systems
/// @throws InvalidInput  a record is missing or no number
void read_systems_of_18(UffLines& lines, double length, UffSystems& systems);
void read_systems_of_2420(UffLines& lines, double length, UffSystems& systems);

/// The systems of a file in its global frame. The file must outlive this object.
///
/// Number 0 is the global frame. In files that define no system, number 1 is the global frame too.
/// Cartesian and cylindrical systems (radius, angle in degrees, height) are supported. A system of
/// dataset 2420 has a 4×3 matrix with the axes in its first three rows and the origin in the fourth
/// row. A place is the row [x y z 1] times this matrix.
class UffFrames {
 public:
  explicit UffFrames(const Uff& uff) : uff_(uff) {}

  /// The node's place in the global frame, in the file's unit of length.
  /// @throws InvalidInput  the node's system cannot be used; says which and why
  [[nodiscard]] Eigen::Vector3d place(long long node) const;
  /// The directions x, y, z (or r, θ, z) at the node as columns, in the global frame.
  /// @throws InvalidInput  as place; or the node lies on the axis of a cylindrical system, where r
  ///                       has no direction
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

/// Turns the directions of channels into the global frame, and sets their places from the file's
/// nodes. A direction or place is removed where its system cannot be used. `notes` say what was
/// turned and what was removed.
/// @param length  metres per unit of the file; none: places are not known
void place_channels(const Uff& uff, std::optional<double> length,
                    std::vector<modal::MeasuredChannel>& channels, std::vector<std::string>& notes);

}  // namespace chladni::io
