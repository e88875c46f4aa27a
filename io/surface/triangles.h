// Triangles and polygons as a file lists them, on their way to a Surface.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "io/read.h"
#include "io/scan.h"

namespace chladni::io {

/// Collects points, triangles and polygons in the order of the file. Nothing is allocated ahead.
class Triangles {
 public:
  /// Adds a point [unit of the file]; its index.
  /// @throws InvalidInput  a coordinate is above 1e50, or there are 2^31 points already
  std::int32_t point(const Eigen::Vector3d& position);
  /// The same, but a point that is there already, bit by bit, is taken again.
  std::int32_t merged_point(const Eigen::Vector3d& position);
  [[nodiscard]] std::int64_t point_count() const {
    return static_cast<std::int64_t>(xyz_.size() / 3);
  }

  /// The index of the patch of that name, new or old.
  int patch(const std::string& name);

  void triangle(std::int32_t a, std::int32_t b, std::int32_t c, int patch);
  /// Three to 1000 corners: a fan where the polygon is convex, ears cut off where it is not. Two or
  /// fewer are passed over and told of.
  /// @throws InvalidInput  more than 1000 corners, told at the place of `scanner`
  void face(std::span<const std::int32_t> corners, int patch, const Scanner& scanner);
  /// `index`, counted from 0, as that of a point that is there.
  /// @throws InvalidInput  it is not there, told at the place of `scanner`
  [[nodiscard]] std::int32_t corner(std::int64_t index, const Scanner& scanner) const;
  [[nodiscard]] std::int64_t triangle_count() const {
    return static_cast<std::int64_t>(patch_.size());
  }

  /// All of it; tells of concave and warped polygons and of faces of two corners.
  /// @throws InvalidInput  there is no triangle
  [[nodiscard]] mesh::Surface surface(Notes* notes) const;

 private:
  [[nodiscard]] Eigen::Vector3d at(std::int32_t point) const;
  void grow_slots();
  void polygon(std::span<const std::int32_t> corners, int patch);
  void cut_ears(std::vector<std::int32_t> corners, const Eigen::Vector3d& normal, int patch);

  std::vector<double> xyz_;
  std::vector<std::int32_t> slots_;  // open addressing by the hash of the coordinates; -1: free
  std::vector<std::int32_t> corners_;
  std::vector<int> patch_;
  std::vector<std::string> names_;
  std::map<std::string, int> patch_of_name_;
  std::int64_t concave_ = 0, warped_ = 0, cornerless_ = 0;
};

}  // namespace chladni::io
