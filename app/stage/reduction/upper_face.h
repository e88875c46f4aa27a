// A body seen from above: a map of two coordinates, and how its modes move there.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "diagnosis/structure.h"
#include "mesh/site.h"

namespace chladni::app {

/// A plane that a body is seen on.
struct Chart {
  Eigen::Vector3d origin;      ///< [m]: that of the body's frame, raised to the height of its top
  Eigen::Matrix3d axes;        ///< columns u, v and the normal, right-handed
  Eigen::Vector2d from, size;  ///< [m]: the body's box on it
  double height = 0.0;         ///< [m]: extent of the body along the normal

  [[nodiscard]] Eigen::Vector2d place(const Eigen::Vector3d& point) const {
    return axes.leftCols<2>().transpose() * (point - origin);
  }
  /// Eight times as long as wide, or more: a line rather than a face.
  [[nodiscard]] bool is_slender() const { return size.maxCoeff() > 8.0 * size.minCoeff(); }
};

/// Of the body's two longest sides, seen from where the third axis points to.
[[nodiscard]] Chart chart_of(const mesh::TetMesh& body);
/// Seen against `normal` (unit). Along an axis of the body u and v are axes too: for z they are x
/// and y, and so on in turn; from behind v is turned.
[[nodiscard]] Chart chart_along(const mesh::TetMesh& body, const Eigen::Vector3d& normal);

/// Places in the plane, `counts` along u and v, evenly over the box: (i + 1/2) / count.
[[nodiscard]] Eigen::Vector2d grid_place(const Chart& chart, const Eigen::Vector2i& counts, int i,
                                         int j);
/// How many along u and v for about `total` of them in squares; one row of `along` where the body
/// is slender.
[[nodiscard]] Eigen::Vector2i grid_counts(const Chart& chart, double total, int along);

/// d(value)/d(offset) at 0 over neighbours `step` away on both sides, or on one where the other is
/// missing; zero where both are.
[[nodiscard]] Eigen::VectorXd slope(
    const std::function<std::optional<Eigen::VectorXd>(double offset)>& value, double step);

/// Modes above those that a diagnosis moves: their flexibility, and that of all beyond.
struct ModesAbove {
  Eigen::MatrixXd shapes;  ///< 3·nodes×u, each over its angular frequency [kg^-1/2 s]
  /// u: the flexibility of a place on itself beyond these modes is Σ beyond_k (its shape_k)².
  Eigen::VectorXd beyond;
};

/// The uppermost faces of a body. Owns what it needs; its functions may run on several threads.
class UpperFace {
 public:
  /// @param shapes  3·nodes×r
  /// @param above   modes that yield at once where something hangs
  /// @param chosen  per boundary face 1 where it counts; empty: all do
  UpperFace(const Chart& chart, const mesh::TetMesh& body, const Eigen::MatrixXd& shapes,
            const ModesAbove& above = {}, std::vector<char> chosen = {});
  UpperFace(const UpperFace&) = delete;
  UpperFace& operator=(const UpperFace&) = delete;

  /// Whether what is uppermost there counts.
  [[nodiscard]] bool holds(const Eigen::Vector2d& place) const;
  /// Along the chart's normal; none beside the body. What yields at once: u modes and one for all
  /// beyond, or none. Cost: five searches, logarithmic in the faces.
  [[nodiscard]] std::optional<diagnosis::PointMotion> at(const Eigen::Vector2d& place) const;

 private:
  [[nodiscard]] std::optional<mesh::Site> uppermost(const Eigen::Vector2d& place) const;

  std::vector<Eigen::Index> nodes_;  // of the body, per node of the shell
  mesh::TetMesh shell_;              // boundary only, in the chart's coordinates
  std::vector<char> chosen_;         // per face of the shell; empty: all
  mesh::SiteFinder finder_;
  Eigen::MatrixXd motion_;  // shell nodes × (r + u)
  Eigen::VectorXd beyond_;  // u
  double step_;             // of slopes [m]
};

/// The part of each of the chart's `counts` rectangles that the body covers: counts(0)×counts(1).
[[nodiscard]] Eigen::MatrixXd coverage(const Chart& chart, const UpperFace& face,
                                       const Eigen::Vector2i& counts);

/// A scan of about 350 places (100 along a slender body), evenly spread; `face` is kept by the map.
[[nodiscard]] diagnosis::Surface surface_of(const Chart& chart,
                                            std::shared_ptr<const UpperFace> face);

}  // namespace chladni::app
