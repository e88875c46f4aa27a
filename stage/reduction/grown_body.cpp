#include "stage/reduction/grown_body.h"

#include <cmath>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

#include "stage/reduction/modal_stiffness.h"

namespace chladni::stage {
namespace {

using Eigen::Index;
using Triplets = std::vector<Eigen::Triplet<double>>;

constexpr double kGrowth = 1e-4;
constexpr double kStillBeneath = 0.5;  // largest miss of a place, over the body's motion there

mesh::TetMesh grown_mesh(mesh::TetMesh body, const Chart& chart, double by) {
  const Eigen::Matrix<double, 3, 2> along = chart.axes.leftCols<2>();
  const Eigen::Vector2d middle = chart.from + 0.5 * chart.size;
  for (Index n = 0; n < body.node_count(); ++n) {
    const Eigen::Vector3d point = body.points.row(n);
    body.points.row(n) += (by * along * (chart.place(point) - middle)).transpose();
  }
  return body;
}

// The body, larger by a part of its size, and its boundary.
struct GrownBody {
  GrownBody(const mesh::TetMesh& body, const Chart& chart, double grown)
      : by(grown), mesh(grown_mesh(body, chart, grown)), finder(mesh) {}
  GrownBody(const GrownBody&) = delete;
  GrownBody& operator=(const GrownBody&) = delete;

  double by;
  mesh::TetMesh mesh;
  mesh::SiteFinder finder;  // of `mesh`
};

// An attachment on the larger body, at its place in space.
struct PlacedAnew {
  fem::Attachment attachment;
  bool is_beneath = true;  // the body lies where the attachment was
};

PlacedAnew placed_on(const GrownBody& body, const fem::Attachment& attachment, const Chart& chart) {
  const Eigen::Vector2d middle = chart.from + 0.5 * chart.size;
  PlacedAnew anew{attachment};
  const auto place = [&](mesh::Site& site) {
    const auto found = body.finder.nearest(site.position);
    const double miss = (found.position - site.position).norm();
    const double moved = std::abs(body.by) * (chart.place(site.position) - middle).norm();
    anew.is_beneath =
        anew.is_beneath && !(miss > kStillBeneath * moved + 1e-12 * chart.size.norm());
    site = found;
  };
  place(anew.attachment.site);
  if (auto* link = std::get_if<fem::LinkSpring>(&anew.attachment.what)) place(link->other);
  return anew;
}

// Φᵀ A Φ of lower triangles on all degrees of freedom, of which few take part.
Eigen::MatrixXd projected(const Triplets& lower, const Solution& solution, Index count) {
  const Index own = solution.modes.dof_count();
  if (lower.empty()) return {};
  std::unordered_map<Index, Index> row_of;
  for (const auto& one : lower) {
    row_of.try_emplace(one.row(), std::ssize(row_of));
    row_of.try_emplace(one.col(), std::ssize(row_of));
  }
  Eigen::MatrixXd shapes(std::ssize(row_of), count);
  for (const auto& [dof, row] : row_of) {
    shapes.row(row) = dof < own ? solution.modes.shapes.row(dof).head(count)
                                : solution.extra_shapes.row(dof - own).head(count);
  }
  Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(shapes.rows(), count);
  for (const auto& one : lower) {
    const Index i = row_of.at(one.row());
    const Index j = row_of.at(one.col());
    forces.row(i) += one.value() * shapes.row(j);
    if (i != j) forces.row(j) += one.value() * shapes.row(i);
  }
  const Eigen::MatrixXd result = shapes.transpose() * forces;
  return 0.5 * (result + result.transpose());
}

// Differences of the terms of attachments, one after the other.
class AttachedDifference {
 public:
  explicit AttachedDifference(const mesh::TetMesh& body, const Chart& chart)
      : body_(body),
        chart_(chart),
        larger_(body, chart, kGrowth),
        smaller_(body, chart, -kGrowth) {}

  void add(const fem::Attachment& attachment) {
    const auto up = placed_on(larger_, attachment, chart_);
    const auto down = placed_on(smaller_, attachment, chart_);
    const bool is_even = up.is_beneath == down.is_beneath;
    const double per_growth = (is_even ? 0.5 : 1.0) / kGrowth;
    if (is_even || up.is_beneath) {
      add(fem::terms(larger_.mesh, {up.attachment}), per_growth);
    } else {
      add(fem::terms(body_, {attachment}), per_growth);
    }
    if (is_even || down.is_beneath) {
      add(fem::terms(smaller_.mesh, {down.attachment}), -per_growth);
    } else {
      add(fem::terms(body_, {attachment}), -per_growth);
    }
    if (std::holds_alternative<fem::Resonator>(attachment.what)) ++extras_;
  }

  [[nodiscard]] diagnosis::BeneathAttached in_modes(const Solution& solution, Index count) const {
    diagnosis::BeneathAttached result{projected(springs_, solution, count),
                                      projected(masses_, solution, count),
                                      projected(dashpots_, solution, count)};
    if (result.springs.size() > 0) {
      result.springs =
          unstrained(std::move(result.springs), solution.modes.frequency_hz.head(count));
    }
    return result;
  }

 private:
  // The degree of freedom that one attachment brings comes after those of the ones before it.
  void add(const fem::AttachmentTerms& terms, double by) {
    const auto own = static_cast<int>(3 * body_.node_count());
    const auto placed = [&](int dof) { return dof < own ? dof : dof + extras_; };
    const auto add_to = [&](Triplets& all, const Triplets& more) {
      for (const auto& one : more) {
        all.emplace_back(placed(one.row()), placed(one.col()), by * one.value());
      }
    };
    add_to(springs_, terms.stiffness);
    add_to(masses_, terms.mass);
    add_to(dashpots_, terms.damping);
  }

  const mesh::TetMesh& body_;
  const Chart& chart_;
  GrownBody larger_, smaller_;
  Triplets springs_, masses_, dashpots_;
  int extras_ = 0;
};

}  // namespace

diagnosis::BeneathAttached beneath_attached(const Solution& solution, Index count,
                                            const Chart& chart) {
  const auto& attachments = solution.model.attachments;
  if (attachments.empty()) return {};
  AttachedDifference all(solution.model.body, chart);
  for (const auto& one : attachments) all.add(one);
  return all.in_modes(solution, count);
}

}  // namespace chladni::stage
