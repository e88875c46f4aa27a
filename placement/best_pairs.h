// The best places for collocated sensor-actuator pairs.
#pragma once

#include <vector>

#include "placement/candidates.h"
#include "placement/wanted_modes.h"

namespace chladni::placement {

/// Input of the criteria at any sites: of a structure, then of each member of its ensemble.
class PairViews {
 public:
  /// The structure must live longer.
  /// @param surface  the points over which norms of the shapes are taken
  PairViews(const Structure& structure, const Sites& surface, WantedModes wanted, const Plan& plan);

  /// @param member  0: the structure; then those of its ensemble
  [[nodiscard]] PairView view(const Sites& sites, std::size_t member) const;
  /// All of them. These views and the sites must live longer.
  [[nodiscard]] Views at(const Sites& sites) const;
  [[nodiscard]] Over over() const { return over_; }

 private:
  [[nodiscard]] Eigen::MatrixXd wanted_part(const Eigen::MatrixXd& shapes,
                                            std::size_t member) const;

  const Structure& structure_;
  WantedModes wanted_;
  std::vector<GroupNorms> norms_;   // of the structure, then of each member
  Eigen::MatrixXd present_;         // p×r: pairs that keep their places
  Eigen::MatrixXd present_slopes_;  // p×m: their slopes
  Eigen::MatrixXd actuators_;       // q×r
  double position_error_;
  Over over_;
};

struct BestPair {
  Eigen::Vector3d position;  ///< [m]
  double score = 0.0;
  int limiting = -1;  ///< index of the group that limits the score
};

struct PairPlaces {
  const Criterion* criterion = nullptr;
  std::vector<HeatMap> maps;    ///< on the surface, one per criterion of `criteria()`
  std::size_t chosen = 0;       ///< index of the map of `criterion`
  std::vector<BestPair> best;   ///< at most ten, best first
  std::vector<BestPair> pairs;  ///< Plan::pairs that are chosen together; empty for one
};

/// Single pairs lie on separate hills of the map, a twentieth of the candidates' extent apart.
/// @param sampler  moves a pair between the candidates to the top of its hill; null: pairs stay on
///                 candidates
/// @param rules    that also hold between the candidates
/// @throws InvalidInput  no criterion has the plan's name, or no site is left for a pair
[[nodiscard]] PairPlaces best_pairs(const PairViews& views, const Sites& surface,
                                    const Candidates& candidates, const Plan& plan,
                                    const Sampler* sampler, const std::vector<Rule>& rules);

}  // namespace chladni::placement
