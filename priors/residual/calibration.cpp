#include "priors/residual/calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "host/parallel.h"
#include "priors/constants.h"

namespace chladni::priors {
namespace {

constexpr double kNoMotion = 1e-300;  // of a shape that is 0 at all places

MeasuredShapes part_of(const MeasuredShapes& measured, const std::vector<Eigen::Index>& rows) {
  return {part(measured.places, rows), measured.frequency_hz, measured.values(rows, Eigen::all),
          measured.noise(rows, Eigen::all)};
}

// All places, those that move the most first: an order that no renumbering, sign, unit or turn of
// the axes changes. Places that move alike follow their coordinates.
std::vector<Eigen::Index> by_motion(const MeasuredShapes& measured) {
  const Eigen::RowVectorXd size = measured.values.colwise().norm().cwiseMax(kNoMotion);
  const Eigen::VectorXd motion =
      (measured.values.array().rowwise() / size.array()).square().rowwise().sum();
  const auto& at = measured.places.position;
  const auto& along = measured.places.direction;
  const auto key = [&](Eigen::Index k) {
    return std::array{-motion(k),  at(k, 0),    at(k, 1),   at(k, 2),
                      along(k, 0), along(k, 1), along(k, 2)};
  };
  std::vector<Eigen::Index> order(static_cast<std::size_t>(measured.places.count()));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, key);
  return order;
}

// For each left-out value: the factor with which the band just contains it.
// @param order  of the places; every fourth one is left out
std::vector<double> factors_of(const MeasuredShapes& measured,
                               const std::vector<Eigen::Index>& order, Eigen::Index which,
                               const Fitting& fit) {
  std::vector<Eigen::Index> kept;
  std::vector<Eigen::Index> left;
  for (Eigen::Index k = 0; k < std::ssize(order); ++k) {
    (k % Constants::parts == which ? left : kept).push_back(order[static_cast<std::size_t>(k)]);
  }
  const auto hidden = part_of(measured, left);
  const auto field = fit(part_of(measured, kept))->at(hidden.places);
  std::vector<double> factors;
  for (Eigen::Index i = 0; i < hidden.values.cols(); ++i) {
    for (Eigen::Index k = 0; k < hidden.values.rows(); ++k) {
      const double away = (hidden.values(k, i) - field.mean(k, i)) / kTwoSided95;
      const double excess = away * away - hidden.noise(k, i) * hidden.noise(k, i);
      factors.push_back(std::sqrt(std::max(excess, 0.0)) / field.deviation(k, i));
    }
  }
  return factors;
}

}  // namespace

double band_factor(const MeasuredShapes& measured, const Fitting& fit) {
  if (measured.places.count() < Constants::fewest_places) return 1.0;
  const auto order = by_motion(measured);
  std::vector<std::vector<double>> by_part(Constants::parts);
  parallel_ranges(Constants::parts, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      by_part[k] = factors_of(measured, order, static_cast<Eigen::Index>(k), fit);
    }
  });
  std::vector<double> factors_of_all;
  for (const auto& factors : by_part)
    factors_of_all.insert(factors_of_all.end(), factors.begin(), factors.end());
  const auto at =
      factors_of_all.begin() +
      static_cast<std::ptrdiff_t>(Constants::held * static_cast<double>(factors_of_all.size()));
  std::nth_element(factors_of_all.begin(), at, factors_of_all.end());
  return std::clamp(*at, Constants::narrowest, Constants::widest);
}

}  // namespace chladni::priors
