// Fewer candidates that cover the same surface.
#pragma once

#include <vector>

#include "base/arrays.h"

namespace chladni::placement {

/// `count` candidates, each the farthest from the earlier ones, beginning with the first.
/// Cost: N per candidate.
[[nodiscard]] std::vector<Eigen::Index> thinned(const Points& position, Eigen::Index count);

/// Where a search by exchange looks: among all candidates; or, where these are more than twice
/// Constants::coarse, among so many that cover them, and then near the chosen ones.
class SearchedCandidates {
 public:
  /// @param position  N×3 [m]; may be empty where the candidates are few. It must outlive this.
  SearchedCandidates(const Points& position, Eigen::Index count);

  [[nodiscard]] bool is_large() const { return is_large_; }
  [[nodiscard]] const std::vector<Eigen::Index>& all() const { return all_; }
  [[nodiscard]] const std::vector<Eigen::Index>& coarse() const { return coarse_; }
  /// Those no farther from `site` than Constants::coarse_reach times the farthest that a candidate
  /// is from its nearest coarse one. Only where `is_large`.
  [[nodiscard]] std::vector<Eigen::Index> near(Eigen::Index site) const;

 private:
  const Points& position_;
  std::vector<Eigen::Index> all_, coarse_;
  bool is_large_ = false;
  double reach_ = 0.0;  // [m]
};

}  // namespace chladni::placement
