#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/interrupt.h"
#include "fem/mirrors.h"

namespace chladni::fem {
namespace {

constexpr double kSamePlace = 1e-8;  // of the body's size
constexpr double kSameEntry = 1e-9;  // of the diagonal

std::string place(const Eigen::RowVector3d& at) {
  const Eigen::RowVector3d mm = 1e3 * at;
  return fmt::format("({:.4g}, {:.4g}, {:.4g}) mm", mm.x(), mm.y(), mm.z());
}

// Points by one linear form of their coordinates, in which few have equal values.
class PlaceFinder {
 public:
  PlaceFinder(const Points& points, double tolerance) : points_(points), tolerance_(tolerance) {
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      sorted_.emplace_back(form(points.row(i)), static_cast<int>(i));
    }
    std::sort(sorted_.begin(), sorted_.end());
  }

  // The first point there for which `serves`; −1: none.
  template <typename Serves>
  [[nodiscard]] int at(const Eigen::RowVector3d& wanted, Serves serves) const {
    const double value = form(wanted);
    const auto reach = 2.0 * tolerance_;
    auto found = std::lower_bound(sorted_.begin(), sorted_.end(),
                                  std::pair{value - reach, std::numeric_limits<int>::min()});
    for (; found != sorted_.end() && found->first <= value + reach; ++found) {
      if ((points_.row(found->second) - wanted).norm() <= tolerance_ && serves(found->second)) {
        return found->second;
      }
    }
    return -1;
  }

 private:
  [[nodiscard]] static double form(const Eigen::RowVector3d& point) {
    return point.dot(Eigen::RowVector3d(0.7548776662, 0.5698402910, 0.3247179572));
  }

  const Points& points_;
  double tolerance_;
  std::vector<std::pair<double, int>> sorted_;
};

class MirrorFinder {
 public:
  MirrorFinder(const mesh::TetMesh& body, const std::vector<Attachment>& attachments,
               const System& system, int axis)
      : body_(body), attachments_(attachments), system_(system), axis_(axis) {
    require(axis >= 0 && axis < 3, "mirror: the axis is 0, 1 or 2");
    const Eigen::RowVector3d low = body.points.colwise().minCoeff();
    const Eigen::RowVector3d high = body.points.colwise().maxCoeff();
    twice_middle_ = low(axis) + high(axis);
    tolerance_ = kSamePlace * (high - low).norm();
    mirror_.axis = axis;
    mirror_.image.setConstant(system.dofs.free_count, -1);
    mirror_.sign.setOnes(system.dofs.free_count);
  }

  Mirror found() {
    take_nodes();
    take_extras();
    require_pairs();
    require_same(system_.stiffness, "stiffness");
    require_same(system_.mass, "mass");
    return std::move(mirror_);
  }

 private:
  [[nodiscard]] Eigen::RowVector3d mirrored(Eigen::RowVector3d point) const {
    point(axis_) = twice_middle_ - point(axis_);
    return point;
  }

  [[noreturn]] void refuse(const Eigen::RowVector3d& at, const std::string& why) const {
    std::string near;
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& attachment : attachments_) {
      const double distance = (attachment.site.position.transpose() - at).norm();
      if (distance >= nearest) continue;
      nearest = distance;
      near = "; the nearest attachment is \"" + attachment.name + "\"";
    }
    throw InvalidInput(fmt::format("the body is not its own mirror image across {}: at {} {}{}",
                                   std::string(1, "xyz"[axis_]), place(at), why, near));
  }

  void take_nodes() {
    const PlaceFinder nodes(body_.points, tolerance_);
    for (Eigen::Index i = 0; i < body_.node_count(); ++i) {
      const Eigen::RowVector3d at = body_.points.row(i);
      const int image = nodes.at(mirrored(at), [](int) { return true; });
      if (image < 0) {
        refuse(at, "it has a node, and none at the image; only bodies in layers have such a mesh");
      }
      for (int direction = 0; direction < 3; ++direction) {
        const int row = system_.dofs.free_dof(3 * i + direction);
        const int other = system_.dofs.free_dof(3 * Eigen::Index{image} + direction);
        if ((row < 0) != (other < 0)) refuse(at, "a support holds it or its image alone");
        if (row < 0) continue;
        mirror_.image(row) = other;
        mirror_.sign(row) = direction == axis_ ? -1.0 : 1.0;
      }
    }
  }

  // Resonators: the one at the image that moves along the mirrored direction, to or fro.
  void take_extras() {
    std::vector<Eigen::RowVector3d> directions;
    for (const auto& attachment : attachments_) {
      if (const auto* resonator = std::get_if<Resonator>(&attachment.what)) {
        directions.push_back(resonator->direction.transpose());
      }
    }
    const auto first = 3 * system_.dofs.node_count;
    const auto count = system_.dofs.extra_count();
    require(static_cast<Eigen::Index>(directions.size()) == count,
            "mirror: the attachments are not those of the system");
    Points at(count, 3);
    for (Eigen::Index e = 0; e < count; ++e) {
      at.row(e) = system_.positions.row(system_.dofs.free_dof(first + e));
    }
    pair_extras(at, directions);
  }

  // Each with an equal one that is not paired yet, with itself where it lies on the plane.
  void pair_extras(const Points& at, const std::vector<Eigen::RowVector3d>& directions) {
    const PlaceFinder extras(at, tolerance_);
    const auto row_of = [&](Eigen::Index e) {
      return system_.dofs.free_dof(3 * system_.dofs.node_count + e);
    };
    for (Eigen::Index e = 0; e < at.rows(); ++e) {
      const int row = row_of(e);
      if (mirror_.image(row) >= 0) continue;
      Eigen::RowVector3d moved = directions[static_cast<std::size_t>(e)];
      moved(axis_) = -moved(axis_);
      const auto along = [&](int other) {
        return moved.dot(directions[static_cast<std::size_t>(other)]);
      };
      const auto serves = [&](int other) {
        return mirror_.image(row_of(other)) < 0 && std::abs(along(other)) > 1.0 - 1e-9;
      };
      const auto find = [&](const auto& takes) { return extras.at(mirrored(at.row(e)), takes); };
      int image = find([&](int other) { return other == e && serves(other); });
      if (image < 0) {
        image = find([&](int other) { return serves(other) && are_equal(row, row_of(other)); });
      }
      if (image < 0) image = find(serves);  // that they differ is told later
      if (image < 0) refuse(at.row(e), "a resonator is there and none at its image");
      for (const auto& [one, other] :
           {std::pair(row, row_of(image)), std::pair(row_of(image), row)}) {
        mirror_.image(one) = other;
        mirror_.sign(one) = along(image) > 0.0 ? 1.0 : -1.0;
      }
    }
  }

  [[nodiscard]] bool are_equal(int one, int other) const {
    const auto same = [&](const SparseMatrix& matrix) {
      const double a = matrix.coeff(one, one);
      const double b = matrix.coeff(other, other);
      return std::abs(a - b) <= kSameEntry * std::max(std::abs(a), std::abs(b));
    };
    return same(system_.stiffness) && same(system_.mass);
  }

  // Where two nodes are at one place it is not known which of them is the image.
  void require_pairs() const {
    for (Eigen::Index i = 0; i < mirror_.image.size(); ++i) {
      const int image = mirror_.image(i);
      if (mirror_.image(image) == i && mirror_.sign(image) == mirror_.sign(i)) continue;
      refuse(system_.positions.row(i), "two nodes share one place");
    }
  }

  void require_same(const SparseMatrix& matrix, const char* what) const {
    const Eigen::VectorXd size = matrix.diagonal().cwiseAbs().cwiseSqrt();
    double worst = 0.0;
    Eigen::Index where = 0;
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) {
      if (c % 65536 == 0) throw_if_interrupted();
      for (SparseMatrix::InnerIterator entry(matrix, c); entry; ++entry) {
        const auto [low, high] = std::minmax(mirror_.image(entry.row()), mirror_.image(c));
        const double image = mirror_.sign(entry.row()) * mirror_.sign(c) * matrix.coeff(high, low);
        const double off = std::abs(entry.value() - image) / (size(entry.row()) * size(c));
        if (!(off <= worst)) {
          worst = off;
          where = c;
        }
      }
    }
    if (worst <= kSameEntry) return;
    refuse(system_.positions.row(where),
           fmt::format("its {} differs from that of the image by {:.2g} %", what, 100.0 * worst));
  }

  const mesh::TetMesh& body_;
  const std::vector<Attachment>& attachments_;
  const System& system_;
  int axis_;
  double twice_middle_ = 0.0, tolerance_ = 0.0;
  Mirror mirror_;
};

}  // namespace

Mirror mirror_of(const mesh::TetMesh& body, const std::vector<Attachment>& attachments,
                 const System& system, int axis) {
  return MirrorFinder(body, attachments, system, axis).found();
}

}  // namespace chladni::fem
