// Triangles and polygons as a file lists them, on their way to a Surface.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "io/read.h"

namespace chladni::io {

/// Collects points, triangles and polygons in the order of the file. Nothing is allocated ahead.
class Triangles {
 public:
  /// Adds a point [unit of the file]; its index.
  /// @throws InvalidInput  there are 2^31 of them already
  std::int32_t point(const Eigen::Vector3d& position);
  /// The same, but a point that is there already, bit by bit, is taken again.
  std::int32_t merged_point(const Eigen::Vector3d& position);
  [[nodiscard]] std::int64_t point_count() const {
    return static_cast<std::int64_t>(xyz_.size() / 3);
  }

  /// The index of the patch of that name, new or old.
  int patch(const std::string& name);

  void triangle(std::int32_t a, std::int32_t b, std::int32_t c, int patch);
  /// Three or more corners: a fan where the polygon is convex, ears cut off where it is not.
  /// @throws InvalidInput  fewer than 3 corners or more than 1000
  void polygon(std::span<const std::int32_t> corners, int patch);
  [[nodiscard]] std::int64_t triangle_count() const {
    return static_cast<std::int64_t>(patch_.size());
  }

  /// All of it; tells of concave and of warped polygons.
  /// @throws InvalidInput  there is no triangle
  [[nodiscard]] mesh::Surface surface(Notes* notes) const;

 private:
  [[nodiscard]] Eigen::Vector3d at(std::int32_t point) const;
  void grow_slots();
  void cut_ears(std::vector<std::int32_t> corners, const Eigen::Vector3d& normal, int patch);

  std::vector<double> xyz_;
  std::vector<std::int32_t> slots_;  // open addressing by the hash of the coordinates; -1: free
  std::vector<std::int32_t> corners_;
  std::vector<int> patch_;
  std::vector<std::string> names_;
  std::map<std::string, int> patch_of_name_;
  std::int64_t concave_ = 0, warped_ = 0;
};

}  // namespace chladni::io
