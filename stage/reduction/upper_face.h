// A body seen from above: a map of two coordinates, with the motion of its modes.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "diagnosis/structure.h"
#include "mesh/site.h"

namespace chladni::stage {

/// A plane on which a body is seen.
struct Chart {
  Eigen::Vector3d origin;      ///< [m]: origin of the body's frame, raised to the body's top
  Eigen::Matrix3d axes;        ///< columns u, v and the normal, right-handed
  Eigen::Vector2d from, size;  ///< [m]: the body's box on it
  double height = 0.0;         ///< [m]: extent of the body along the normal

  [[nodiscard]] Eigen::Vector2d place(const Eigen::Vector3d& point) const {
    return axes.leftCols<2>().transpose() * (point - origin);
  }
  /// True if it is at least eight times as long as wide: a line rather than a face.
  [[nodiscard]] bool is_slender() const { return size.maxCoeff() > 8.0 * size.minCoeff(); }
};

/// The chart of the body's two longest sides, seen from the positive side of the third axis.
[[nodiscard]] Chart chart_of(const mesh::TetMesh& body);
/// The chart seen against `normal` (unit). If the normal is an axis of the body, u and v are axes
/// too: x and y for z, and cyclically. For a negative axis v is turned.
[[nodiscard]] Chart chart_along(const mesh::TetMesh& body, const Eigen::Vector3d& normal);

/// Places of a regular grid in the box, `counts` along u and v: (i + 1/2) / count.
[[nodiscard]] Eigen::Vector2d grid_place(const Chart& chart, const Eigen::Vector2i& counts, int i,
                                         int j);
/// Numbers along u and v for about `total` squares; one row of `along` if the body is slender.
[[nodiscard]] Eigen::Vector2i grid_counts(const Chart& chart, double total, int along);

/// d(value)/d(offset) at 0 from neighbours `step` away on both sides, or on one side if the other
/// is missing; zero if both are missing.
[[nodiscard]] Eigen::VectorXd slope(
    const std::function<std::optional<Eigen::VectorXd>(double offset)>& value, double step);

/// Modes above those in use: their flexibility, and that of all modes beyond them.
struct ModesAbove {
  Eigen::MatrixXd shapes;  ///< 3·nodes×u, each divided by its angular frequency [kg^-1/2 s]
  /// u: the own flexibility of a place beyond these modes is Σ beyond_k (its shape_k)².
  Eigen::VectorXd beyond;
};

/// The uppermost faces of a body. It owns its data; its functions may run on several threads.
class UpperFace {
 public:
  /// A row for each node: a place has those of its few nodes.
  using Motions = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  /// @param shapes  3·nodes×r
  /// @param above   modes that yield statically under an attachment
  /// @param chosen  per boundary face 1 if it counts; empty: all count
  UpperFace(const Chart& chart, const mesh::TetMesh& body, const Eigen::MatrixXd& shapes,
            const ModesAbove& above = {}, std::vector<char> chosen = {});
  UpperFace(const UpperFace&) = delete;
  UpperFace& operator=(const UpperFace&) = delete;

  /// True if the uppermost face at this place counts.
  [[nodiscard]] bool holds(const Eigen::Vector2d& place) const;
  /// Height of that face over the plane of the chart [m]; none outside the body.
  [[nodiscard]] std::optional<double> height(const Eigen::Vector2d& place) const;
  /// Motion along the chart's axes; none outside the body. The static part has u modes and one
  /// entry for all beyond, or is empty. Cost: five searches, logarithmic in the faces.
  [[nodiscard]] std::optional<diagnosis::PointMotion> at(const Eigen::Vector2d& place) const;

 private:
  [[nodiscard]] std::optional<mesh::Site> uppermost(const Eigen::Vector2d& place) const;

  std::vector<Eigen::Index> nodes_;  // of the body, per node of the shell
  mesh::TetMesh shell_;              // boundary only, in the chart's coordinates
  std::vector<char> chosen_;         // per face of the shell; empty: all
  mesh::SiteFinder finder_;
  std::array<Motions, 3> motions_;  // along u, v and the normal: shell nodes × (r + u)
  Eigen::VectorXd beyond_;          // u
  double step_;                     // of slopes [m]
};

/// The part of each of the chart's `counts` rectangles that the body covers: counts(0)×counts(1).
[[nodiscard]] Eigen::MatrixXd coverage(const Chart& chart, const UpperFace& face,
                                       const Eigen::Vector2i& counts);

/// A scan of about 350 places (100 along a slender body), evenly spread; the map owns `face`.
[[nodiscard]] diagnosis::Surface surface_of(const Chart& chart,
                                            std::shared_ptr<const UpperFace> face);

}  // namespace chladni::stage
