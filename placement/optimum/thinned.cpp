#include "placement/optimum/thinned.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "placement/constants.h"

namespace chladni::placement {
namespace {

// The farthest that a candidate is from its nearest coarse one, times Constants::coarse_reach [m].
double reach_of(const Points& position, const std::vector<Eigen::Index>& coarse) {
  double longest = 0.0;
  for (Eigen::Index c = 0; c < position.rows(); ++c) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto other : coarse) {
      nearest = std::min(nearest, (position.row(c) - position.row(other)).squaredNorm());
    }
    longest = std::max(longest, nearest);
  }
  return Constants::coarse_reach * std::sqrt(longest);
}

}  // namespace

std::vector<Eigen::Index> thinned(const Points& position, Eigen::Index count) {
  std::vector<Eigen::Index> chosen{0};
  Eigen::VectorXd distance = (position.rowwise() - position.row(0)).rowwise().squaredNorm();
  while (static_cast<Eigen::Index>(chosen.size()) < count) {
    Eigen::Index farthest = 0;
    distance.maxCoeff(&farthest);
    chosen.push_back(farthest);
    distance =
        distance.cwiseMin((position.rowwise() - position.row(farthest)).rowwise().squaredNorm());
  }
  return chosen;
}

SearchedCandidates::SearchedCandidates(const Points& position, Eigen::Index count)
    : position_(position),
      all_(static_cast<std::size_t>(count)),
      is_large_(count > 2 * Constants::coarse) {
  std::iota(all_.begin(), all_.end(), 0);
  coarse_ = is_large_ ? thinned(position, Constants::coarse) : all_;
  if (is_large_) reach_ = reach_of(position, coarse_);
}

std::vector<Eigen::Index> SearchedCandidates::near(Eigen::Index site) const {
  std::vector<Eigen::Index> found;
  for (const auto c : all_) {
    if ((position_.row(c) - position_.row(site)).norm() <= reach_) found.push_back(c);
  }
  return found;
}

}  // namespace chladni::placement
