// The layout whose sites tell the wanted modes apart best, and how far from it another can be.
#pragma once

#include <vector>

#include "base/arrays.h"

namespace chladni::placement {

/// Choose `count` of N candidates so that log det(P + Σ φ_c φ_cᵀ) is largest (D-optimality: the
/// volume of the confidence ellipsoid of the modal amplitudes is smallest).
struct DeterminantProblem {
  Eigen::MatrixXd rows;   ///< N×r: what each candidate sees, over its noise
  Eigen::MatrixXd prior;  ///< r×r: information that is there already, positive semidefinite
  Eigen::Index count = 0;
  Points position;       ///< N×3 [m]; may be empty where spacing is 0
  double spacing = 0.0;  ///< [m] between two chosen sites
};

/// m sites.
struct Choice {
  std::vector<Eigen::Index> sites;  ///< ascending
  double score = 0.0;               ///< log det of their information
  double bound = 0.0;               ///< no choice scores more; may be loose (see `certificate`)
  bool proven = false;              ///< no choice scores more than this one
  int nodes = 0;                    ///< of the search tree

  /// D-efficiency that is certain: exp((score − bound) / r) in (0, 1].
  [[nodiscard]] double certificate(Eigen::Index r) const;
};

/// One after the other, each the best beside those before it: at least 1 − 1/e of the best gain
/// (Nemhauser, Wolsey and Fisher 1978); with a vanishing prior, column-pivoted QR. All candidates
/// are updated by one rank, so that an exact step costs what a lazy one would: N r.
/// @throws InvalidInput  fewer candidates than sites (or spacing leaves too few)
[[nodiscard]] std::vector<Eigen::Index> greedy(const DeterminantProblem& problem);

/// Swaps the pair (one in, one out) that gains most until none gains (Fedorov 1972). N r per swap
/// and site.
[[nodiscard]] std::vector<Eigen::Index> exchanged(const DeterminantProblem& problem,
                                                  std::vector<Eigen::Index> sites);

[[nodiscard]] double log_determinant(const DeterminantProblem& problem,
                                     const std::vector<Eigen::Index>& sites);

struct DeterminantOptions {
  int starts = 3;        ///< random ones beside greedy and the rounded relaxation
  int node_limit = 0;    ///< of the branch and bound that proves the optimum; 0: the bound alone
  double enough = 1e-9;  ///< stop when bound − score is below it
  unsigned seed = 1;     ///< of the random starts
};

/// Greedy, the rounded relaxation and random starts, refined by exchange; the bound from the
/// concave relaxation 0 <= z <= 1 (Joshi and Boyd 2009), which ignores spacing; then branch and
/// bound with reduced-cost fixing. Where there are more modes than sites, or spacing decides, the
/// bound is true but far.
/// @throws InvalidInput  as greedy, or an entry is not finite
[[nodiscard]] Choice best_determinant(const DeterminantProblem& problem,
                                      const DeterminantOptions& options = {});

}  // namespace chladni::placement
