#include "placement/heat_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/interrupt.h"

namespace chladni::placement {
namespace {

void append_row(Eigen::MatrixXd& matrix, const Eigen::RowVectorXd& row) {
  matrix.conservativeResize(matrix.rows() + 1, row.size());
  matrix.bottomRows<1>() = row;
}

// Combines a member's scores with those of the members before it.
void add_score(Eigen::MatrixXd score, Over over, bool is_first, HeatMap& map) {
  require(is_first || (score.rows() == map.by_group.rows() && score.cols() == map.by_group.cols()),
          "heat map: the models of the ensemble differ in sites or groups of modes");
  if (is_first) {
    map.by_group = std::move(score);
  } else if (over == Over::worst) {
    map.by_group = map.by_group.cwiseMin(score);
  } else {
    map.by_group += score;
  }
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

Views views_of(std::vector<PairView> ensemble) {
  const auto count = ensemble.size();
  return {count, [all = std::move(ensemble)](std::size_t member) { return all[member]; }};
}

std::vector<HeatMap> heat_maps(std::span<const Criterion* const> all, const Views& views,
                               Over over) {
  require(views.count > 0, "heat map: there is no model");
  std::vector<HeatMap> maps(all.size());
  for (std::size_t member = 0; member < views.count; ++member) {
    const auto view = views.view(member);
    for (std::size_t c = 0; c < all.size(); ++c) {
      throw_if_interrupted();
      add_score(all[c]->score(view), over, member == 0, maps[c]);
    }
  }
  for (auto& map : maps) {
    if (over == Over::mean) map.by_group /= static_cast<double>(views.count);
    map.score.resize(map.by_group.rows());
    map.limiting.resize(map.by_group.rows());
    for (Eigen::Index i = 0; i < map.score.size(); ++i) {
      map.score(i) = map.by_group.row(i).minCoeff(&map.limiting(i));
    }
  }
  return maps;
}

HeatMap heat_map(const Criterion& criterion, const Views& views, Over over) {
  const std::array all{&criterion};
  return heat_maps(all, views, over).front();
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

std::vector<ChosenPair> chosen_pairs(const Criterion& criterion, const Views& views, Over over,
                                     const Points& position,
                                     const std::vector<Eigen::Index>& allowed, double spacing,
                                     int count) {
  std::vector<ChosenPair> chosen;
  const Views beside{views.count, [&](std::size_t member) {
                       auto view = views.view(member);
                       for (const auto& pair : chosen) {
                         append_row(view.present, view.shapes.row(pair.site));
                         append_row(view.present_slopes, view.slopes.row(pair.site));
                       }
                       return view;
                     }};
  std::vector<Eigen::Index> left = allowed;
  for (int k = 0; k < count; ++k) {
    require(!left.empty(), "placement: " + fmt::to_string(count) + " pairs at least " +
                               fmt::format("{:.6g}", 1e3 * spacing) + " mm apart do not fit; " +
                               fmt::to_string(k) + " do");
    const HeatMap map = heat_map(criterion, beside, over);
    const Eigen::Index site = best_sites(map.score, position, left, 0.0, 1).front();
    chosen.push_back({site, map.score(site), map.limiting(site)});
    std::erase_if(left, [&](Eigen::Index other) {
      return other == site || (position.row(site) - position.row(other)).norm() < spacing;
    });
  }
  return chosen;
}

}  // namespace chladni::placement
