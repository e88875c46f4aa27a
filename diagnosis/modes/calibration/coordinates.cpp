#include "diagnosis/modes/calibration/coordinates.h"

#include <cmath>

#include "base/index.h"
#include "diagnosis/fit/information.h"

namespace chladni::diagnosis {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd coordinates(const std::vector<Supposed>& causes) {
  Index n = 0;
  for (const auto& cause : causes) n += cause.x.size();
  VectorXd all(n);
  n = 0;
  for (const auto& cause : causes) {
    all.segment(n, cause.x.size()) = cause.x;
    n += cause.x.size();
  }
  return all;
}

std::vector<Supposed> moved(std::vector<Supposed> causes, const VectorXd& step) {
  Index first = 0;
  for (auto& cause : causes) {
    cause.x += step.segment(first, cause.x.size());
    first += cause.x.size();
  }
  return causes;
}

VectorXd CoordinatePrior::slope(const VectorXd& x) const {
  VectorXd result = precision.cwiseProduct(x - centre);
  for (std::size_t i = 0; i < is_place.size(); ++i) {
    if (is_place[i]) result(static_cast<Index>(i)) = 0.0;
  }
  return result;
}

std::vector<Supposed> supposed(const std::vector<HeldConstant>& constants, const VectorXd& x,
                               const std::vector<Supposed>& causes) {
  std::vector<Supposed> all;
  for (std::size_t i = 0; i < constants.size(); ++i) {
    const double at = x.size() == 0 ? 0.0 : x(static_cast<Index>(i));
    all.push_back({constants[i].effect, 0, VectorXd::Constant(1, at)});
  }
  all.insert(all.end(), causes.begin(), causes.end());
  return all;
}

CoordinatePrior prior_of(const Structure& structure, const std::vector<HeldConstant>& constants,
                         const std::vector<Supposed>& all) {
  const Index n = coordinates(all).size();
  CoordinatePrior prior{VectorXd::Zero(n), VectorXd::Zero(n), VectorXd::Zero(n), {}};
  Index i = 0;
  for (std::size_t c = 0; c < all.size(); ++c) {
    for (const auto& parameter : all[c].effect->parameters(structure)) {
      prior.centre(i) = parameter.centre;
      const double width =
          c < constants.size() ? constants[c].width : prior_width(structure, parameter);
      prior.precision(i) = std::pow(width, -2);
      prior.is_place.push_back(parameter.is_place());
      prior.step(i++) = parameter.step;
    }
  }
  return prior;
}

double log_prior(const Structure& structure, const std::vector<HeldConstant>& constants,
                 const std::vector<Supposed>& all) {
  const auto held = static_cast<Index>(constants.size());
  double sum = log_prior(constants, VectorXd(coordinates(all).head(held)));
  for (std::size_t c = constants.size(); c < all.size(); ++c) sum += log_prior(all[c], structure);
  return sum;
}

ModeErrors with_sizes(ModeErrors errors, const Eigen::MatrixXd& slope, const CoordinatePrior& prior,
                      const Eigen::VectorXd& x) {
  const VectorXd off = x - prior.centre;
  const VectorXd width = prior.precision.cwiseSqrt().cwiseInverse();
  const Index n = slope.cols();
  errors.shared_of.insert(errors.shared_of.end(), at(n), -1);
  Index first = 0;
  for (auto& block : errors.blocks) {
    const auto own = slope.middleRows(first, block.count());
    const Index before = block.shared.cols();
    block.shared.conservativeResize(Eigen::NoChange, before + n);
    block.shared.rightCols(n) = own * width.asDiagonal();
    for (Index c = 0; c < n; ++c) {
      if (!prior.is_place[at(c)]) block.error -= own.col(c) * off(c);
    }
    first += block.count();
  }
  return errors;
}

}  // namespace chladni::diagnosis
