// Numbers of the whole body that nearly do the same are all heard before one is named.
#include "diagnosis/search/scales.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "diagnosis/small_plate.h"

namespace chladni::diagnosis {
namespace {

using Eigen::VectorXd;

Supposed scale(const char* name, double by) {
  return {&effect(name), 0, VectorXd::Constant(1, std::log1p(by))};
}

// A free plate that is 4 % too light, with 1 % of noise, and a search that came to other causes.
class Scales : public testing::Test {
 protected:
  Scales() {
    State state = state_of(plate_);
    change_of(scale("density", -0.04), plate_)(state);
    observed_ = with_noise(observed_in(state, 100.0), 5);
  }

  Found found_with(const std::vector<Supposed>& causes) const {
    Found found;
    found.nothing = fitted(problem_, Fit{});
    Fit start;
    start.causes = causes;
    found.fits = {fitted(problem_, start), found.nothing};
    return found;
  }

  const Structure& plate_ = small_plate();
  const std::vector<const Effect*> catalogue_{effects().begin(), effects().end()};
  const std::vector<Deviation> none_;
  Observed observed_;
  Problem problem_{plate_, observed_, none_};
};

// M (1 + r) is K / (1 + r) and a scale 1 / (1 + r) of all responses: one cause instead of two.
TEST_F(Scales, OneStandsForTwoThatDoTheSame) {
  auto found = found_with({scale("youngs_modulus", 0.04), scale("overall_gain", 0.04)});
  EXPECT_TRUE(add_scales(problem_, catalogue_, found));
  const auto& best = found.fits.front();
  ASSERT_EQ(best.causes.size(), 1U);
  EXPECT_EQ(best.causes.front().effect->name, "density");
  EXPECT_NEAR(std::expm1(best.causes.front().x(0)), -0.04, 2e-3);
}

TEST_F(Scales, AreHeardBesideOtherCauses) {
  const Supposed mass{&effect("point_mass"), 0, Eigen::Vector3d(0.05, 0.1, -0.05)};
  auto found = found_with({mass, scale("youngs_modulus", 0.04)});
  (void)add_scales(problem_, catalogue_, found);
  for (const std::string_view name : {"density", "thickness", "overall_gain"}) {
    EXPECT_TRUE(std::ranges::any_of(found.fits, [&](const Fit& fit) {
      return fit.causes.size() == 2 && fit.causes.front().effect->name == "point_mass" &&
             fit.causes.back().effect->name == name;
    })) << name;
  }
}

TEST_F(Scales, AreNotSoughtWhereNoneWasFound) {
  auto found = found_with({{&effect("sensor_gain"), 0, VectorXd::Constant(1, 0.03)}});
  EXPECT_FALSE(add_scales(problem_, catalogue_, found));
  EXPECT_EQ(found.fits.size(), 2U);
}

}  // namespace
}  // namespace chladni::diagnosis
