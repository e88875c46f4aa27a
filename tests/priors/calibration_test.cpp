// The factor on the bands of a fit, from places that are left out in turn.
#include "priors/residual/calibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "plate_case.h"

namespace chladni::priors {
namespace {

MeasuredShapes in_order(const MeasuredShapes& measured, const std::vector<Eigen::Index>& order) {
  return {part(measured.places, order), measured.frequency_hz, measured.values(order, Eigen::all),
          measured.noise(order, Eigen::all)};
}

std::vector<Eigen::Index> shuffled(Eigen::Index count, unsigned seed) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(seed);
  for (std::size_t k = order.size(); k-- > 1;) std::swap(order[k], order[random() % (k + 1)]);
  return order;
}

double factor_of(const PlateCase& made, const MeasuredShapes& measured) {
  return band_factor(measured, [&](const MeasuredShapes& seen) {
    return mode_field(interpolator("thin_plate_spline"), seen, made.simulation);
  });
}

// The rings have places of one distance from the middle, that only their values tell apart.
TEST(BandFactor, DoesNotCareForTheOrderOfThePlaces) {
  for (const std::string layout : {"rings", "rand1"}) {
    const auto made = plate_case(layout, 1, 8);
    const double factor = factor_of(made, made.measured);
    EXPECT_GT(factor, 0.75) << layout << ": at its bound it tells nothing of the parts";
    EXPECT_LT(factor, 4.0) << layout;
    for (const unsigned seed : {1U, 2U, 3U, 4U}) {
      const auto order = shuffled(made.measured.places.count(), seed);
      EXPECT_NEAR(factor_of(made, in_order(made.measured, order)), factor, 1e-6 * factor)
          << layout << ", order " << seed;
    }
  }
}

// Without noise the images of a symmetric place move alike.
TEST(BandFactor, DoesNotCareForTheOrderOfPlacesThatMoveAlike) {
  auto made = plate_case("rings", 1, 3);
  auto& measured = made.measured;
  for (Eigen::Index k = 0; k < measured.places.count(); ++k) {
    const double r = measured.places.position.row(k).norm();
    measured.values.row(k) << std::cos(60.0 * r), std::cos(45.0 * r), std::sin(30.0 * r);
  }
  const double factor = factor_of(made, measured);
  EXPECT_GT(factor, 0.75);
  EXPECT_LT(factor, 4.0);
  for (const unsigned seed : {1U, 2U, 3U, 4U}) {
    const auto order = shuffled(measured.places.count(), seed);
    EXPECT_NEAR(factor_of(made, in_order(measured, order)), factor, 1e-6 * factor) << seed;
  }
}

TEST(BandFactor, IsOneWhereNothingCanBeLeftOut) {
  const auto made = plate_case("rings", 1, 4);
  const std::vector<Eigen::Index> few{0, 1, 2, 3, 4, 5, 6};
  EXPECT_EQ(factor_of(made, in_order(made.measured, few)), 1.0);
}

}  // namespace
}  // namespace chladni::priors
