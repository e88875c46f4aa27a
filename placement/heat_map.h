// Where a collocated pair belongs.
#pragma once

#include "placement/criteria.h"
#include "placement/sites.h"

namespace chladni::placement {

/// What is known of the noise of an experiment, per mode.
struct PairNoise {
  Eigen::VectorXd sensor, actuator;  ///< m [kg^-1/2]
  double position_error = 0.0;       ///< [m], standard deviation per axis
};

/// One model of the body: modes on its surface. An ensemble of them says what is not known.
struct SurfaceModes {
  Eigen::MatrixXd shapes;  ///< n×m [kg^-1/2], wanted modes at the candidate sites
  Eigen::MatrixXd slopes;  ///< n×m [kg^-1/2 m^-1]
};

/// Norms of the groups over a surface of `area`-weighted points: for `PairView`.
struct GroupNorms {
  Eigen::VectorXd largest, rms;  ///< g
};
[[nodiscard]] GroupNorms group_norms(const Eigen::MatrixXd& shapes, const Eigen::VectorXd& area,
                                     const std::vector<modal::ModeGroup>& groups);

enum class Over { worst, mean };

/// n sites, g groups of modes.
struct HeatMap {
  Eigen::MatrixXd by_group;  ///< n×g: the criterion's scores, over the ensemble
  Eigen::VectorXd score;     ///< n: of the group that limits the site
  Eigen::VectorXi limiting;  ///< n: that group
};

/// One view per member of the ensemble, all of the same sites and groups: each group's score is the
/// worst or the mean over the members.
/// @throws InvalidInput  there is no view, or they differ in size
[[nodiscard]] HeatMap heat_map(const Criterion& criterion, const std::vector<PairView>& ensemble,
                               Over over = Over::worst);

/// The rows of `allowed` with the highest scores, at least `spacing` [m] apart, best first; equal
/// ones in their order. At most `count`.
[[nodiscard]] std::vector<Eigen::Index> best_sites(const Eigen::VectorXd& score,
                                                   const Points& position,
                                                   const std::vector<Eigen::Index>& allowed,
                                                   double spacing, Eigen::Index count);

/// Pairs chosen one after the other, each the best beside those before it.
struct ChosenPair {
  Eigen::Index site = -1;
  double score = 0.0;  ///< of all pairs so far
  int limiting = -1;   ///< group
};
/// @param ensemble  without pairs in place but those that are really there
/// @throws InvalidInput  `allowed` and `spacing` leave no site for one of them
[[nodiscard]] std::vector<ChosenPair> chosen_pairs(const Criterion& criterion,
                                                   std::vector<PairView> ensemble, Over over,
                                                   const Points& position,
                                                   const std::vector<Eigen::Index>& allowed,
                                                   double spacing, int count);

}  // namespace chladni::placement
