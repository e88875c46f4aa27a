#include "io/surface/triangles.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "io/cells/tet_shape.h"

namespace chladni::io {
namespace {

constexpr double kWarp = 1e-3;  // limit of a corner's distance from the plane, over the size

std::uint64_t mixed(std::uint64_t x) {  // splitmix64's finaliser
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31U);
}

std::uint64_t hash(const Eigen::Vector3d& p) {
  std::uint64_t h = 0x9e3779b97f4a7c15ULL;
  for (int i = 0; i < 3; ++i) h = mixed(h + std::bit_cast<std::uint64_t>(p[i]));
  return h;
}

// Twice the area of the triangle abc along `normal`; negative for the opposite orientation.
double turn(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
            const Eigen::Vector3d& normal) {
  return (b - a).cross(c - a).dot(normal);
}

}  // namespace

Eigen::Vector3d Triangles::at(std::int32_t point) const {
  return Eigen::Map<const Eigen::Vector3d>(&xyz_[3 * static_cast<std::size_t>(point)]);
}

std::int32_t Triangles::point(const Eigen::Vector3d& position) {
  require(position.cwiseAbs().maxCoeff() < kLargestCoordinate,
          "point " + fmt::to_string(point_count() + 1) + " has a coordinate above 1e50");
  require(point_count() < std::numeric_limits<std::int32_t>::max(),
          "more than 2147483647 points: coarsen the surface in the program that wrote it");
  for (int i = 0; i < 3; ++i) xyz_.push_back(position[i] + 0.0);  // −0 becomes 0
  return static_cast<std::int32_t>(point_count() - 1);
}

void Triangles::grow_slots() {
  slots_.assign(std::max<std::size_t>(16, 2 * slots_.size()), -1);
  const std::size_t mask = slots_.size() - 1;
  for (std::int32_t p = 0; p < point_count(); ++p) {
    std::size_t slot = hash(at(p)) & mask;
    while (slots_[slot] >= 0) slot = (slot + 1) & mask;
    slots_[slot] = p;
  }
}

std::int32_t Triangles::merged_point(const Eigen::Vector3d& position) {
  if (2 * static_cast<std::size_t>(point_count() + 1) > slots_.size()) grow_slots();
  const Eigen::Vector3d wanted = position.array() + 0.0;
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = hash(wanted) & mask;
  for (; slots_[slot] >= 0; slot = (slot + 1) & mask) {
    if (at(slots_[slot]) == wanted) return slots_[slot];
  }
  slots_[slot] = point(wanted);
  return slots_[slot];
}

int Triangles::patch(const std::string& name) {
  const auto [entry, is_new] = patch_of_name_.try_emplace(name, static_cast<int>(names_.size()));
  if (is_new) names_.push_back(name);
  return entry->second;
}

void Triangles::triangle(std::int32_t a, std::int32_t b, std::int32_t c, int patch) {
  corners_.insert(corners_.end(), {a, b, c});
  patch_.push_back(patch);
}

std::int32_t Triangles::corner(std::int64_t index, const Scanner& scanner) const {
  if (index < 0 || index >= point_count()) {
    scanner.fail("a face names point " + fmt::to_string(index) + ", expected 0 to " +
                 fmt::to_string(point_count() - 1));
  }
  return static_cast<std::int32_t>(index);
}

void Triangles::face(std::span<const std::int32_t> corners, int patch, const Scanner& scanner) {
  constexpr std::size_t kMostCorners = 1000;
  if (corners.size() > kMostCorners) {
    scanner.fail("a face has " + fmt::to_string(corners.size()) + " corners, expected at most " +
                 fmt::to_string(kMostCorners) + ": triangulate it where it was made");
  }
  if (corners.size() < 3) {
    ++cornerless_;
  } else if (corners.size() == 3) {
    triangle(corners[0], corners[1], corners[2], patch);
  } else {
    polygon(corners, patch);
  }
}

void Triangles::polygon(std::span<const std::int32_t> corners, int patch) {
  const std::size_t n = corners.size();
  const Eigen::Vector3d origin = at(corners[0]);
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // Newell's: twice the area vector
  double size = 0.0;
  for (std::size_t i = 1; i < n; ++i) {
    normal += (at(corners[i]) - origin).cross(at(corners[(i + 1) % n]) - origin);
    size = std::max(size, (at(corners[i]) - origin).norm());
  }
  normal.normalize();
  bool convex = true, warped = false;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d next = at(corners[(i + 1) % n]);
    convex = convex && turn(at(corners[i]), next, at(corners[(i + 2) % n]), normal) >= 0.0;
    warped = warped || std::abs((next - origin).dot(normal)) > kWarp * size;
  }
  concave_ += convex ? 0 : 1;
  warped_ += warped ? 1 : 0;
  if (!convex) return cut_ears({corners.begin(), corners.end()}, normal, patch);
  for (std::size_t i = 1; i + 1 < n; ++i) triangle(corners[0], corners[i], corners[i + 1], patch);
}

// Cuts off one corner after another. The triangle at the corner must have the polygon's orientation
// and contain no other corner. Where rounding leaves no such corner, any corner is cut off; the
// check of the surface finds the consequences.
void Triangles::cut_ears(std::vector<std::int32_t> corners, const Eigen::Vector3d& normal,
                         int patch) {
  while (corners.size() > 3) {
    const std::size_t n = corners.size();
    std::size_t ear = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const std::int32_t ia = corners[(i + n - 1) % n], ib = corners[i], ic = corners[(i + 1) % n];
      const Eigen::Vector3d a = at(ia), b = at(ib), c = at(ic);
      const bool holds_one = std::any_of(corners.begin(), corners.end(), [&](std::int32_t other) {
        if (other == ia || other == ib || other == ic) return false;
        const Eigen::Vector3d p = at(other);
        return turn(a, b, p, normal) >= 0.0 && turn(b, c, p, normal) >= 0.0 &&
               turn(c, a, p, normal) >= 0.0;
      });
      if (turn(a, b, c, normal) > 0.0 && !holds_one) {
        ear = i;
        break;
      }
    }
    triangle(corners[(ear + n - 1) % n], corners[ear], corners[(ear + 1) % n], patch);
    corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  triangle(corners[0], corners[1], corners[2], patch);
}

mesh::Surface Triangles::surface(Notes* notes) const {
  require(!patch_.empty(), "no triangle in the file, expected a closed surface");
  mesh::Surface result;
  result.points = Eigen::Map<const Points>(xyz_.data(), point_count(), 3);
  result.triangles = Eigen::Map<const Cells>(corners_.data(), triangle_count(), 3);
  result.patch = Eigen::Map<const Eigen::VectorXi>(patch_.data(), triangle_count());
  result.patch_names = names_;
  if (warped_ > 0) {
    add_note(notes,
             fmt::to_string(warped_) + " polygons are not flat: cut into triangles as they are");
  }
  if (cornerless_ > 0) {
    add_note(notes, fmt::to_string(cornerless_) + " faces of fewer than three corners left out");
  }
  if (concave_ > 0)
    add_note(notes, fmt::to_string(concave_) + " concave polygons cut into triangles");
  return result;
}

}  // namespace chladni::io
