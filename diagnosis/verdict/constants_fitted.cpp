#include "diagnosis/verdict/constants_fitted.h"

#include <algorithm>
#include <cmath>

#include "base/index.h"

namespace chladni::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd start_of(const std::vector<HeldConstant>& constants,
                  const std::vector<CalibratedNumber>& start) {
  VectorXd x = VectorXd::Zero(std::ssize(constants));
  for (Index i = 0; i < x.size(); ++i) {
    const auto number =
        std::ranges::find(start, constants[at(i)].stated.name, &CalibratedNumber::name);
    if (number == start.end() || !number->determined) continue;
    x(i) = std::log(number->value / number->of_study);
  }
  return x;
}

std::vector<Deviation> constant_deviations(const Structure& structure,
                                           const std::vector<HeldConstant>& constants,
                                           const VectorXd& start) {
  std::vector<Deviation> all;
  for (Index i = 0; i < start.size(); ++i) {
    const auto& constant = constants[at(i)];
    const auto apply = [&structure, from = start(i), width = constant.width,
                        effect = constant.effect](State& state, double eta) {
      effect->apply(state, structure, 0, VectorXd::Constant(1, from + width * eta));
    };
    all.push_back({constant.stated.name, apply, true});
  }
  return all;
}

FittedConstants constants_of(const Fit& fit, const std::vector<HeldConstant>& constants,
                             const VectorXd& start, Index first) {
  VectorXd width(start.size());
  for (Index i = 0; i < width.size(); ++i) width(i) = constants[at(i)].width;
  const Index row = fit.coordinate_count() + first;
  const MatrixXd covariance = fit.covariance.block(row, row, width.size(), width.size())
                                  .cwiseProduct(width * width.transpose());
  return {start + width.cwiseProduct(fit.eta.segment(first, width.size())), covariance};
}

}  // namespace chladni::diagnosis
