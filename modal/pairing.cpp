#include "modal/pairing.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "modal/mac.h"

namespace chladni::modal {
namespace {

constexpr double kOrder = 1e-9;  // cost of a change of order, by its square

struct Group {
  Eigen::Index first = 0, size = 1;
};

// Rigid-body modes form one group. Flexible modes form a group within `gap` above its first mode.
std::vector<Group> groups(const Modes& modes, double gap) {
  std::vector<Group> result;
  if (modes.rigid_count > 0) result.push_back({0, modes.rigid_count});
  for (auto k = modes.rigid_count; k < modes.mode_count();) {
    auto end = k + 1;
    while (end < modes.mode_count() &&
           modes.frequency_hz(end) <= (1.0 + gap) * modes.frequency_hz(k)) {
      ++end;
    }
    result.push_back({k, end - k});
    k = end;
  }
  return result;
}

// For each mode of `of` (rows) and column of `shapes`: the part of the column in the span
// of the mode's group.
Eigen::MatrixXd share_in_groups(const Modes& of, const Eigen::MatrixXd& shapes, double gap) {
  Eigen::MatrixXd share(of.mode_count(), shapes.cols());
  const Eigen::MatrixXd unit = shapes.colwise().normalized();
  for (const auto& group : groups(of, gap)) {
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(
        of.shapes.middleCols(group.first, group.size).colwise().normalized());
    const Eigen::MatrixXd basis =
        qr.householderQ() * Eigen::MatrixXd::Identity(of.dof_count(), qr.rank());
    const Eigen::RowVectorXd part = (basis.transpose() * unit).colwise().squaredNorm();
    share.middleRows(group.first, group.size) = part.cwiseMin(1.0).replicate(group.size, 1);
  }
  return share;
}

// Shortest augmenting paths with potentials (Jonker and Volgenant's form of the Hungarian method).
// Rows and columns count from 1; a path starts at column 0, and row 0 means no row.
class Assignment {
 public:
  explicit Assignment(const Eigen::MatrixXd& cost)
      : cost_(cost),
        row_potential_(static_cast<std::size_t>(cost.rows()) + 1, 0.0),
        column_potential_(static_cast<std::size_t>(cost.cols()) + 1, 0.0),
        row_of_(column_potential_.size(), 0) {
    for (std::size_t row = 1; row < row_potential_.size(); ++row) give_column(row);
  }

  [[nodiscard]] const std::vector<std::size_t>& row_of() const { return row_of_; }

 private:
  // Changes the assignment along the cheapest path from `row` to a free column.
  void give_column(std::size_t row) {
    least_.assign(row_of_.size(), std::numeric_limits<double>::infinity());
    before_.assign(row_of_.size(), 0);
    seen_.assign(row_of_.size(), 0);
    row_of_[0] = row;
    std::size_t column = 0;
    do {
      column = next_column(column);
    } while (row_of_[column] != 0);
    for (; column != 0; column = before_[column]) row_of_[column] = row_of_[before_[column]];
  }

  // Returns the nearest unseen column after the step from `column`'s row. The potentials change so
  // that this column has the distance 0.
  std::size_t next_column(std::size_t column) {
    seen_[column] = 1;
    const auto row = row_of_[column];
    std::size_t nearest = 0;
    for (std::size_t j = 1; j < row_of_.size(); ++j) {
      if (seen_[j] != 0) continue;
      const double reduced =
          cost_(static_cast<Eigen::Index>(row) - 1, static_cast<Eigen::Index>(j) - 1) -
          row_potential_[row] - column_potential_[j];
      if (reduced < least_[j]) {
        least_[j] = reduced;
        before_[j] = column;
      }
      if (nearest == 0 || least_[j] < least_[nearest]) nearest = j;
    }
    const double step = least_[nearest];
    for (std::size_t j = 0; j < row_of_.size(); ++j) {
      if (seen_[j] != 0) {
        row_potential_[row_of_[j]] += step;
        column_potential_[j] -= step;
      } else {
        least_[j] -= step;
      }
    }
    return nearest;
  }

  const Eigen::MatrixXd& cost_;
  std::vector<double> row_potential_, column_potential_;
  std::vector<std::size_t> row_of_;  // row of each column
  std::vector<double> least_;        // distance of each column from the start of the path
  std::vector<std::size_t> before_;
  std::vector<char> seen_;
};

// The column of each row; rows <= columns.
std::vector<Eigen::Index> assigned_columns(const Eigen::MatrixXd& cost) {
  const Assignment assignment(cost);
  std::vector<Eigen::Index> result(static_cast<std::size_t>(cost.rows()), -1);
  for (std::size_t j = 1; j < assignment.row_of().size(); ++j) {
    const auto row = assignment.row_of()[j];
    if (row != 0) result[row - 1] = static_cast<Eigen::Index>(j) - 1;
  }
  return result;
}

// The cost of a pair that is never made.
constexpr double kNever = std::numeric_limits<double>::max();

// Costs below `alone` of the pairs that may be made. The frequencies' part fills what the shapes
// leave up to there: it starts with the slope of ln², and no distance forbids a pair.
Eigen::MatrixXd costs(const Modes& a, const Modes& b, const Eigen::MatrixXd& alike,
                      const PairingOptions& options, double alone) {
  Eigen::MatrixXd cost(a.mode_count(), b.mode_count());
  for (Eigen::Index i = 0; i < cost.rows(); ++i) {
    for (Eigen::Index j = 0; j < cost.cols(); ++j) {
      const bool rigid = i < a.rigid_count;
      if (rigid != (j < b.rigid_count) || alike(i, j) < options.least_mac) {
        cost(i, j) = kNever;
        continue;
      }
      // Equal costs (repeated modes) keep the order: the last term is convex in i − j.
      cost(i, j) = 1.0 - alike(i, j) + kOrder * std::pow(static_cast<double>(i - j), 2);
      if (rigid) continue;
      const double ratio = std::log(b.frequency_hz(j) / a.frequency_hz(i));
      const double room = alone - cost(i, j);
      const double far = options.frequency_weight * ratio * ratio;
      cost(i, j) += room / (1.0 + room / far);  // 0 where they are equal
    }
  }
  return cost;
}

std::vector<Eigen::Index> without(Eigen::Index count, const std::vector<Eigen::Index>& taken) {
  std::vector<Eigen::Index> rest;
  for (Eigen::Index k = 0; k < count; ++k) {
    if (std::find(taken.begin(), taken.end(), k) == taken.end()) rest.push_back(k);
  }
  return rest;
}

}  // namespace

Eigen::MatrixXd alike(const Modes& a, const Modes& b, double repeated_gap) {
  return mac(a.shapes, b.shapes)
      .cwiseMax(share_in_groups(a, b.shapes, repeated_gap))
      .cwiseMax(share_in_groups(b, a.shapes, repeated_gap).transpose());
}

std::vector<std::pair<Eigen::Index, Eigen::Index>> assigned(const Eigen::MatrixXd& cost,
                                                            double alone) {
  const Eigen::MatrixXd capped = cost.cwiseMin(alone);
  const bool wide = cost.rows() <= cost.cols();
  const auto partner = assigned_columns(wide ? capped : Eigen::MatrixXd(capped.transpose()));
  std::vector<std::pair<Eigen::Index, Eigen::Index>> pairs;
  for (std::size_t k = 0; k < partner.size(); ++k) {
    const auto own = static_cast<Eigen::Index>(k);
    const auto i = wide ? own : partner[k];
    const auto j = wide ? partner[k] : own;
    if (cost(i, j) < alone) pairs.emplace_back(i, j);
  }
  std::ranges::sort(pairs);
  return pairs;
}

Pairing pairing(const Modes& a, const Modes& b, const PairingOptions& options) {
  const Eigen::MatrixXd alike = modal::alike(a, b, options.repeated_gap);
  const auto most = static_cast<double>(std::max(a.mode_count(), b.mode_count()));
  const double alone = 1.0 - options.least_mac + 2.0 * kOrder * most * most;
  Pairing result;
  std::vector<Eigen::Index> taken_a;
  std::vector<Eigen::Index> taken_b;
  for (const auto& [i, j] : assigned(costs(a, b, alike, options, alone), alone)) {
    const bool rigid = i < a.rigid_count;
    result.pairs.push_back(
        {.a = i,
         .b = j,
         .mac = alike(i, j),
         .frequency_change = rigid ? 0.0 : b.frequency_hz(j) / a.frequency_hz(i) - 1.0});
    taken_a.push_back(i);
    taken_b.push_back(j);
  }
  result.alone_a = without(a.mode_count(), taken_a);
  result.alone_b = without(b.mode_count(), taken_b);
  return result;
}

}  // namespace chladni::modal
