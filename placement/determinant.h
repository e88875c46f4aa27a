// The layout whose sites distinguish the wanted modes best, and a bound for all other layouts.
#pragma once

#include <vector>

#include "base/arrays.h"

namespace chladni::placement {

/// Choose `count` of N candidates so that log det(P + Σ φ_c φ_cᵀ) is largest (D-optimality: the
/// volume of the confidence ellipsoid of the modal amplitudes is smallest).
struct DeterminantProblem {
  Eigen::MatrixXd rows;   ///< N×r: the candidate's row over its noise
  Eigen::MatrixXd prior;  ///< r×r: existing information, positive semidefinite
  Eigen::Index count = 0;
  Points position;       ///< N×3 [m]; may be empty if spacing is 0
  double spacing = 0.0;  ///< [m], least distance between two chosen sites
};

/// A choice of m sites.
struct Choice {
  std::vector<Eigen::Index> sites;  ///< ascending
  double score = 0.0;               ///< log det of their information
  double bound = 0.0;               ///< no choice scores more; may be loose (see `certificate`)
  bool proven = false;              ///< no choice has a higher score
  int nodes = 0;                    ///< nodes of the search tree

  /// Guaranteed D-efficiency: exp((score − bound) / r) in (0, 1].
  [[nodiscard]] double certificate(Eigen::Index r) const;
};

/// Chooses one site after the other, each the best beside the earlier ones. This gives at least
/// 1 − 1/e of the best gain (Nemhauser, Wolsey and Fisher 1978); with a vanishing prior it is
/// column-pivoted QR. A rank-one update serves all candidates, so an exact step costs as little
/// as a lazy one: N r.
/// @throws InvalidInput  fewer candidates than sites (or spacing leaves too few)
[[nodiscard]] std::vector<Eigen::Index> greedy(const DeterminantProblem& problem);

/// Makes the swap (one site in, one out) with the largest gain until none gains (Fedorov 1972).
/// Cost: N r per swap and site.
[[nodiscard]] std::vector<Eigen::Index> exchanged(const DeterminantProblem& problem,
                                                  std::vector<Eigen::Index> sites);

[[nodiscard]] double log_determinant(const DeterminantProblem& problem,
                                     const std::vector<Eigen::Index>& sites);

struct DeterminantOptions {
  int starts = 3;        ///< random starts, beside greedy and the rounded relaxation
  int node_limit = 0;    ///< of the branch and bound that proves the optimum; 0: only the bound
  double enough = 1e-9;  ///< the search stops when bound − score is below it
  unsigned seed = 1;     ///< of the random starts
};

/// Exchange refines the greedy choice, the rounded relaxation and random starts. The concave
/// relaxation 0 <= z <= 1 (Joshi and Boyd 2009), which ignores spacing, gives the bound. Then
/// branch and bound with reduced-cost fixing follows. With more modes than sites, or if spacing
/// decides, the bound is valid but loose.
/// @throws InvalidInput  as greedy, an entry is not finite, or not one position per candidate
[[nodiscard]] Choice best_determinant(const DeterminantProblem& problem,
                                      const DeterminantOptions& options = {});

}  // namespace chladni::placement
