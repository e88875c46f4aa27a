#include "diagnosis/modes/errors/mixing_modes.h"

#include <algorithm>
#include <cmath>

#include "base/index.h"
#include "diagnosis/constants.h"

namespace chladni::diagnosis {

using Eigen::Index;

std::vector<MixingMode> mixed_by_stiffness(const RecordedModes& model, Index k,
                                           const Eigen::VectorXd& parts) {
  std::vector<MixingMode> all;
  const bool is_turned = parts.squaredNorm() > parts(k) * parts(k);
  for (Index l = 0; l < model.count(); ++l) {
    const double gap = std::abs(std::log(model.frequency_hz(l) / model.frequency_hz(k)));
    if ((l == k && !is_turned) || gap >= kConstants.nearby) continue;
    all.push_back({l, 1.0 / std::max(gap, kConstants.least_gap) - 1.0 / kConstants.nearby});
  }
  return all;
}

std::vector<MixingMode> mixed_by_damping(const MeasuredModes& measured, const RecordedModes& model,
                                         const Matching& matching, Index i) {
  const auto ratio_of = [&](Index mode) {
    const double ratio = measured.damping_ratio(mode);
    return ratio > 0.0 ? ratio : std::max(0.0, model.damping_ratio(matching.model[at(mode)]));
  };
  std::vector<MixingMode> all;
  const Index k = matching.model[at(i)];
  for (Index j = 0; j < measured.count(); ++j) {
    const Index l = matching.model[at(j)];
    if (l < 0 || l == k) continue;
    const double apart = std::log(measured.frequency_hz(j) / measured.frequency_hz(i));
    const double gap = std::hypot(apart, ratio_of(j) - ratio_of(i));  // of the poles, over ω
    const double coupled = kConstants.damping_coupling * std::sqrt(ratio_of(i) * ratio_of(j));
    if (!(gap < kConstants.nearby && coupled > 0.0)) continue;
    all.push_back({j, coupled / std::max(gap, coupled) * (1.0 - gap / kConstants.nearby)});
  }
  return all;
}

Eigen::MatrixXd shapes_mixed(const std::vector<MixingMode>& modes, const Eigen::MatrixXd& shapes) {
  Eigen::MatrixXd result(shapes.rows(), std::ssize(modes));
  for (std::size_t j = 0; j < modes.size(); ++j) {
    result.col(static_cast<Index>(j)) = modes[j].part * shapes.col(modes[j].mode);
  }
  return result;
}

Eigen::MatrixXd shapes_across(const std::vector<MixingMode>& modes, const Eigen::MatrixXd& shapes,
                              const Eigen::VectorXd& own, const Eigen::VectorXd& parts) {
  Eigen::MatrixXd result = shapes_mixed(modes, shapes);
  for (std::size_t j = 0; j < modes.size(); ++j) {
    result.col(static_cast<Index>(j)) -= modes[j].part * parts(modes[j].mode) * own;
  }
  return result;
}

}  // namespace chladni::diagnosis
