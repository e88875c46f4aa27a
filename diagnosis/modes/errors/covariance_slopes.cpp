#include "diagnosis/modes/errors/covariance_slopes.h"

namespace chladni::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;

CovarianceSlopes::CovarianceSlopes(const ModeErrors& here, const PerClass& levels)
    : levels_(levels) {
  for (const auto& block : here.blocks) {
    covariances_.push_back(covariance_of(block, here.shared_of, levels));
    factors_.push_back(covariance_factor(covariances_.back()));
    count_ += factors_.back().size();
  }
}

Eigen::VectorXd CovarianceSlopes::of(const ModeErrors& there, double step) const {
  Eigen::VectorXd all(count_);
  Index first = 0;
  for (std::size_t b = 0; b < factors_.size(); ++b) {
    const auto lower = factors_[b].triangularView<Eigen::Lower>();
    MatrixXd change =
        (covariance_of(there.blocks[b], there.shared_of, levels_) - covariances_[b]) / step;
    lower.solveInPlace(change);
    change.transposeInPlace();
    lower.solveInPlace(change);
    all.segment(first, change.size()) = change.reshaped();
    first += change.size();
  }
  return all;
}

}  // namespace chladni::diagnosis
