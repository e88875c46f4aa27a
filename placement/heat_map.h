// Map of good places for a collocated pair.
#pragma once

#include <functional>

#include "placement/criteria.h"
#include "placement/sites.h"

namespace chladni::placement {

/// The known noise of an experiment, per mode.
struct PairNoise {
  Eigen::VectorXd sensor, actuator;  ///< m [kg^-1/2]
  double position_error = 0.0;       ///< [m], standard deviation per axis
};

/// One model of the body: modes on its surface. An ensemble of models represents the uncertainty.
struct SurfaceModes {
  Eigen::MatrixXd shapes;  ///< n×m [kg^-1/2], wanted modes at the candidate sites
  Eigen::MatrixXd slopes;  ///< n×m [kg^-1/2 m^-1]
};

/// Norms of the groups over surface points weighted by `area`, for `PairView`.
struct GroupNorms {
  Eigen::VectorXd largest, rms;  ///< g
};
[[nodiscard]] GroupNorms group_norms(const Eigen::MatrixXd& shapes, const Eigen::VectorXd& area,
                                     const std::vector<modal::ModeGroup>& groups);

enum class Over { worst, mean };

/// The views of an ensemble, which are made one after the other: all at once may be gigabytes.
struct Views {
  std::size_t count = 0;
  std::function<PairView(std::size_t member)> view;
};
/// Those of models that are all at hand.
[[nodiscard]] Views views_of(std::vector<PairView> ensemble);

/// n sites, g groups of modes.
struct HeatMap {
  Eigen::MatrixXd by_group;  ///< n×g: the criterion's scores, combined over the ensemble
  Eigen::VectorXd score;     ///< n: score of the group that limits the site
  Eigen::VectorXi limiting;  ///< n: that group
};

/// Each member of the ensemble gives one view, with the same sites and groups. Each group's score
/// is the worst or the mean over the members.
/// @throws InvalidInput  there is no view, or they differ in size
[[nodiscard]] HeatMap heat_map(const Criterion& criterion, const Views& views,
                               Over over = Over::worst);

/// The map of each criterion. Every view is made once.
[[nodiscard]] std::vector<HeatMap> heat_maps(std::span<const Criterion* const> all,
                                             const Views& views, Over over = Over::worst);

/// The rows of `allowed` with the highest scores, at least `spacing` [m] apart, best first; equal
/// scores keep their order. At most `count`.
[[nodiscard]] std::vector<Eigen::Index> best_sites(const Eigen::VectorXd& score,
                                                   const Points& position,
                                                   const std::vector<Eigen::Index>& allowed,
                                                   double spacing, Eigen::Index count);

/// One of the pairs that are chosen one after the other, each the best beside the earlier ones.
struct ChosenPair {
  Eigen::Index site = -1;
  double score = 0.0;  ///< of all pairs up to this one
  int limiting = -1;   ///< the limiting group
};
/// @param views  their pairs in place are only those that really exist
/// @throws InvalidInput  `allowed` and `spacing` leave no site for a pair
[[nodiscard]] std::vector<ChosenPair> chosen_pairs(const Criterion& criterion, const Views& views,
                                                   Over over, const Points& position,
                                                   const std::vector<Eigen::Index>& allowed,
                                                   double spacing, int count);

}  // namespace chladni::placement
