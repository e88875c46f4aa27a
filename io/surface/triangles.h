// Collects triangles and polygons as a file lists them, and makes a Surface.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "io/read.h"
#include "io/scan.h"

namespace chladni::io {

/// Collects points, triangles and polygons in the order of the file. No memory is allocated in
/// advance.
class Triangles {
 public:
  /// Adds a point [unit of the file]; returns its index.
  /// @throws InvalidInput  a coordinate is above 1e50, or there are 2^31 points already
  std::int32_t point(const Eigen::Vector3d& position);
  /// Like `point`, but a point with exactly the same coordinates is used again.
  std::int32_t merged_point(const Eigen::Vector3d& position);
  [[nodiscard]] std::int64_t point_count() const {
    return static_cast<std::int64_t>(xyz_.size() / 3);
  }

  /// The index of the patch with that name, new or old.
  int patch(const std::string& name);

  void triangle(std::int32_t a, std::int32_t b, std::int32_t c, int patch);
  /// Adds a polygon of three to 1000 corners. A convex polygon becomes a fan; from other polygons
  /// ears are cut off. A polygon of two or fewer corners is skipped and noted.
  /// @throws InvalidInput  more than 1000 corners; the message has the place of `scanner`
  void face(std::span<const std::int32_t> corners, int patch, const Scanner& scanner);
  /// `index` (from 0) as the index of an existing point.
  /// @throws InvalidInput  there is no such point; the message has the place of `scanner`
  [[nodiscard]] std::int32_t corner(std::int64_t index, const Scanner& scanner) const;
  [[nodiscard]] std::int64_t triangle_count() const {
    return static_cast<std::int64_t>(patch_.size());
  }

  /// The surface. Adds notes about concave and warped polygons and about faces of two corners.
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
