#include "placement/optimum/thinned.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "placement/constants.h"

namespace chladni::placement {

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

std::vector<Eigen::Index> all_of(Eigen::Index count) {
  std::vector<Eigen::Index> all(static_cast<std::size_t>(count));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

}  // namespace chladni::placement
