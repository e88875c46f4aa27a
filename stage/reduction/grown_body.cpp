#include "stage/reduction/grown_body.h"

#include <cmath>
#include <numbers>
#include <utility>
#include <variant>
#include <vector>

namespace chladni::stage {
namespace {

using Eigen::Index;

constexpr double kSmall = 1e-4;  // growth for slopes
constexpr double kUneven = 0.4;  // part of a miss by which the one to the other side is less
constexpr double kFarthest = 0.18;
constexpr int kSteps = 5;

// Steps of 1 - 1/λ, closest at both ends.
Eigen::VectorXd steps() {
  Eigen::VectorXd all(kSteps);
  for (int j = 1; j <= kSteps; ++j) {
    all(j - 1) = 0.5 * kFarthest * (1.0 - std::cos(std::numbers::pi * j / kSteps));
  }
  return all;
}

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

// Values at the one or two sites of an attachment, along the axes of the body's frame.
using AtSites = Eigen::Matrix<double, 2, 3>;

// An attachment on the larger body.
struct PlacedAnew {
  fem::Attachment attachment;
  AtSites misses = AtSites::Zero();  // [m]: from where it was to be
};

// @param motion  of the sites per growth: zero if they stay in space
PlacedAnew placed_on(const GrownBody& body, const fem::Attachment& attachment,
                     const AtSites& motion) {
  PlacedAnew anew{attachment};
  const auto place = [&](mesh::Site& site, Index row) {
    const Eigen::Vector3d wanted = site.position + body.by * motion.row(row).transpose();
    site = body.finder.nearest(wanted);
    anew.misses.row(row) = (site.position - wanted).transpose();
  };
  place(anew.attachment.site, 0);
  if (auto* link = std::get_if<fem::LinkSpring>(&anew.attachment.what)) place(link->other, 1);
  return anew;
}

// True where the body no longer lies beneath the attachment at `here`, but does at `there`. A face
// that looks along u or v, or that is curved, moves away by as much on both sides.
bool is_off(const PlacedAnew& here, const PlacedAnew& there, const Chart& chart) {
  const Eigen::Matrix2d missed = (here.misses * chart.axes.leftCols<2>()).cwiseAbs();
  const Eigen::Matrix2d other = (there.misses * chart.axes.leftCols<2>()).cwiseAbs();
  const double rounding = 1e-8 * chart.size.norm();
  return ((1.0 - kUneven) * missed.array() > other.array() + rounding).any();
}

// How the sites follow the faces that they are on, per growth [m].
AtSites motion_of(const fem::Attachment& attachment, const GrownBody& smaller,
                  const GrownBody& larger, const Chart& chart) {
  const auto down = placed_on(smaller, attachment, AtSites::Zero());
  const auto up = placed_on(larger, attachment, AtSites::Zero());
  const bool is_off_up = is_off(up, down, chart);
  const bool is_off_down = is_off(down, up, chart);
  if (is_off_up == is_off_down) return (up.misses - down.misses) / (larger.by - smaller.by);
  return is_off_up ? AtSites(down.misses / smaller.by) : AtSites(up.misses / larger.by);
}

// The forms of attachments on one body, in the modes.
struct Rows {
  Eigen::MatrixXd springs, masses, dashpots;  // n×r, times the roots of their values
};

Eigen::MatrixXd in_modes(const std::vector<fem::AttachmentTerms::Form>& forms,
                         const Solution& solution, Index count, Index extras) {
  const Index own = solution.modes.dof_count();
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(std::ssize(forms), count);
  for (Index i = 0; i < rows.rows(); ++i) {
    const auto& form = forms[static_cast<std::size_t>(i)];
    for (const auto& [dof, factor] : form.row) {
      const double by = std::sqrt(form.value) * factor;
      rows.row(i) += by * (dof < own ? solution.modes.shapes.row(dof).head(count)
                                     : solution.extra_shapes.row(dof - own + extras).head(count));
    }
  }
  return rows;
}

// All attachments of a solution on its body and on smaller and larger ones.
class OnSizes {
 public:
  OnSizes(const Solution& solution, Index count, const Chart& chart)
      : solution_(solution), count_(count), chart_(chart) {
    const GrownBody smaller(solution.model.body, chart, -kSmall);
    const GrownBody larger(solution.model.body, chart, kSmall);
    Index extras = 0;
    for (const auto& one : attachments()) {
      extras_.push_back(extras);
      extras += std::holds_alternative<fem::Resonator>(one.what) ? 1 : 0;
      motions_.push_back(motion_of(one, smaller, larger, chart));
      here_.push_back(rows_of(extras_.size() - 1, solution.model.body, one));
    }
  }

  [[nodiscard]] diagnosis::BeneathAttached result() const {
    diagnosis::BeneathAttached all;
    const auto each = {std::pair{&Rows::springs, &all.springs},
                       std::pair{&Rows::masses, &all.masses},
                       std::pair{&Rows::dashpots, &all.dashpots}};
    for (const auto& [kind, forms] : each) {
      forms->steps = steps();
      forms->rows = stacked(here_, kind);
    }
    for (const double step : steps()) {
      const auto [smaller, larger] = on_both(step);
      for (const auto& [kind, forms] : each) {
        forms->smaller.push_back(stacked(smaller, kind));
        forms->larger.push_back(stacked(larger, kind));
      }
    }
    return all;
  }

 private:
  using All = std::vector<Rows>;  // per attachment

  [[nodiscard]] const std::vector<fem::Attachment>& attachments() const {
    return solution_.model.attachments;
  }

  [[nodiscard]] Rows rows_of(std::size_t i, const mesh::TetMesh& body,
                             const fem::Attachment& placed) const {
    const auto terms = fem::terms(body, {placed});
    const auto shaped = [&](const auto& forms) {
      return in_modes(forms, solution_, count_, extras_[i]);
    };
    return {shaped(terms.springs), shaped(terms.masses), shaped(terms.dashpots)};
  }

  // Where one of the two bodies does not lie beneath a part, its rows go on as they came from the
  // other.
  [[nodiscard]] std::pair<All, All> on_both(double step) const {
    const GrownBody smaller(solution_.model.body, chart_, 1.0 / (1.0 + step) - 1.0);
    const GrownBody larger(solution_.model.body, chart_, 1.0 / (1.0 - step) - 1.0);
    std::pair<All, All> both;
    for (std::size_t i = 0; i < attachments().size(); ++i) {
      const auto down = placed_on(smaller, attachments()[i], motions_[i]);
      const auto up = placed_on(larger, attachments()[i], motions_[i]);
      const bool is_off_down = is_off(down, up, chart_);
      const bool is_off_up = is_off(up, down, chart_);
      Rows less = rows_of(i, smaller.mesh, down.attachment);
      Rows more = rows_of(i, larger.mesh, up.attachment);
      if (is_off_down && !is_off_up) less = beyond(here_[i], more);
      if (is_off_up && !is_off_down) more = beyond(here_[i], less);
      both.first.push_back(std::move(less));
      both.second.push_back(std::move(more));
    }
    return both;
  }

  static Rows beyond(const Rows& here, const Rows& other) {
    return {2.0 * here.springs - other.springs, 2.0 * here.masses - other.masses,
            2.0 * here.dashpots - other.dashpots};
  }

  [[nodiscard]] Eigen::MatrixXd stacked(const All& all, Eigen::MatrixXd Rows::*kind) const {
    Eigen::MatrixXd rows(0, count_);
    for (const auto& one : all) {
      const Index before = rows.rows();
      rows.conservativeResize(before + (one.*kind).rows(), Eigen::NoChange);
      rows.bottomRows(rows.rows() - before) = one.*kind;
    }
    return rows;
  }

  const Solution& solution_;
  Index count_;
  const Chart& chart_;
  std::vector<Index> extras_;  // degrees of freedom that the attachments before bring
  std::vector<AtSites> motions_;
  All here_;
};

}  // namespace

diagnosis::BeneathAttached beneath_attached(const Solution& solution, Index count,
                                            const Chart& chart) {
  if (solution.model.attachments.empty()) return {};
  auto all = OnSizes(solution, count, chart).result();
  for (Index j = 0; j < count; ++j) {  // a motion at 0 Hz stretches no spring
    if (solution.modes.frequency_hz(j) == 0.0) all.springs.rows.col(j).setZero();
  }
  return all;
}

}  // namespace chladni::stage
