#include "placement/heat_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "base/error.h"
#include "base/interrupt.h"

namespace chladni::placement {
namespace {

void append_row(Eigen::MatrixXd& matrix, const Eigen::RowVectorXd& row) {
  matrix.conservativeResize(matrix.rows() + 1, row.size());
  matrix.bottomRows<1>() = row;
}

}  // namespace

GroupNorms group_norms(const Eigen::MatrixXd& shapes, const Eigen::VectorXd& area,
                       const std::vector<modal::ModeGroup>& groups) {
  const auto count = static_cast<Eigen::Index>(groups.size());
  GroupNorms norms{Eigen::VectorXd(count), Eigen::VectorXd(count)};
  for (Eigen::Index g = 0; g < count; ++g) {
    const auto [first, size] = groups[static_cast<std::size_t>(g)];
    const Eigen::VectorXd square = shapes.middleCols(first, size).rowwise().squaredNorm();
    norms.largest(g) = std::sqrt(square.maxCoeff() / static_cast<double>(size));
    norms.rms(g) = std::sqrt(square.dot(area) / (area.sum() * static_cast<double>(size)));
  }
  return norms;
}

HeatMap heat_map(const Criterion& criterion, const std::vector<PairView>& ensemble, Over over) {
  require(!ensemble.empty(), "heat map: there is no model");
  HeatMap map;
  for (const auto& view : ensemble) {
    throw_if_interrupted();
    require(view.site_count() == ensemble[0].site_count() &&
                view.group_count() == ensemble[0].group_count(),
            "heat map: the models of the ensemble differ in sites or groups of modes");
    const Eigen::MatrixXd score = criterion.score(view);
    if (map.by_group.size() == 0) {
      map.by_group = score;
    } else if (over == Over::worst) {
      map.by_group = map.by_group.cwiseMin(score);
    } else {
      map.by_group += score;
    }
  }
  if (over == Over::mean) map.by_group /= static_cast<double>(ensemble.size());
  map.score.resize(map.by_group.rows());
  map.limiting.resize(map.by_group.rows());
  for (Eigen::Index i = 0; i < map.score.size(); ++i) {
    map.score(i) = map.by_group.row(i).minCoeff(&map.limiting(i));
  }
  return map;
}

std::vector<Eigen::Index> best_sites(const Eigen::VectorXd& score, const Points& position,
                                     const std::vector<Eigen::Index>& allowed, double spacing,
                                     Eigen::Index count) {
  std::vector<Eigen::Index> order = allowed;
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return score(a) > score(b); });
  std::vector<Eigen::Index> best;
  for (const auto site : order) {
    if (static_cast<Eigen::Index>(best.size()) == count) break;
    const bool free = std::all_of(best.begin(), best.end(), [&](Eigen::Index other) {
      return (position.row(site) - position.row(other)).norm() >= spacing;
    });
    if (free) best.push_back(site);
  }
  return best;
}

std::vector<ChosenPair> chosen_pairs(const Criterion& criterion, std::vector<PairView> ensemble,
                                     Over over, const Points& position,
                                     const std::vector<Eigen::Index>& allowed, double spacing,
                                     int count) {
  std::vector<ChosenPair> chosen;
  std::vector<Eigen::Index> left = allowed;
  for (int k = 0; k < count; ++k) {
    require(!left.empty(), "placement: " + fmt::to_string(count) + " pairs at least " +
                               fmt::format("{:.6g}", 1e3 * spacing) + " mm apart do not fit; " +
                               fmt::to_string(k) + " do");
    const HeatMap map = heat_map(criterion, ensemble, over);
    const Eigen::Index site = best_sites(map.score, position, left, 0.0, 1).front();
    chosen.push_back({site, map.score(site), map.limiting(site)});
    for (auto& view : ensemble) {
      append_row(view.present, view.shapes.row(site));
      append_row(view.present_slopes, view.slopes.row(site));
    }
    std::erase_if(left, [&](Eigen::Index other) {
      return other == site || (position.row(site) - position.row(other)).norm() < spacing;
    });
  }
  return chosen;
}

}  // namespace chladni::placement
