#include "diagnosis/search/elsewhere.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "diagnosis/small_plate.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

// 2 g that swing at 281 Hz.
Supposed resonator_at(const Vector2d& place) {
  VectorXd x(5);
  x << std::log(2e-3), std::log(281.0), std::log(0.02), place;
  return {&effect("resonator"), 0, x};
}

class Elsewhere : public testing::Test {
 protected:
  std::vector<Supposed> seen_from(const Supposed& cause) const {
    return elsewhere(problem_, fit_with({}), cause);
  }
  // How far from the truth a fit ends.
  double missed_from(const Supposed& start) const {
    const Fit fit = fitted(problem_, fit_with({start}));
    return (*place_of(fit.causes.front(), plate_) - place_).norm();
  }

  Fit fit_with(std::vector<Supposed> causes) const {
    Fit fit;
    fit.causes = std::move(causes);
    fit.eta = VectorXd::Zero(std::ssize(gains_));
    return fit;
  }

  const Structure& plate_ = small_plate();
  const Vector2d place_{0.09, -0.06};
  const Observed observed_ = [this] {
    State state = state_of(plate_);
    change_of(resonator_at(place_), plate_)(state);
    return observed_in(state, 100.0);
  }();
  const std::vector<Deviation> gains_ = [this] {
    Tolerances gain = no_tolerances();
    gain.gain = 5e-3;
    return deviations(plate_, gain, 900.0);
  }();
  const Problem problem_{plate_, observed_, gains_};
};

TEST_F(Elsewhere, LeadsFromAMinimumToTheTruth) {
  const Supposed wrong = resonator_at({-0.1, 0.07});
  EXPECT_GT(missed_from(wrong), 0.05);
  const auto found = seen_from(wrong);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().x.head(3), wrong.x.head(3));
  EXPECT_LT(missed_from(found.front()), 5e-3);  // 2 g in 1 % of noise
}

TEST_F(Elsewhere, SeesNothingFromTheRightOne) {
  EXPECT_TRUE(seen_from(resonator_at(place_)).empty());
}

TEST_F(Elsewhere, SpreadsASpringToThePadAroundIt) {
  const std::vector<const Effect*> catalogue{&effect("ground_spring"), &effect("elastic_pad"),
                                             &effect("resonator"), &effect("mass_with_inertia")};
  const Supposed spring{&effect("ground_spring"), 0,
                        Eigen::Vector3d(std::log(2e5), place_.x(), place_.y())};
  const auto pads = spread_out(problem_, fit_with({spring}), catalogue);
  ASSERT_EQ(pads.size(), 1U);
  EXPECT_EQ(pads.front().effect, &effect("elastic_pad"));
  EXPECT_DOUBLE_EQ(pads.front().x(0), spring.x(0));
  EXPECT_EQ(*place_of(pads.front(), plate_), place_);
  // What is no special case of an effect with an extent.
  EXPECT_TRUE(spread_out(problem_, fit_with({resonator_at(place_)}), catalogue).empty());
  const Supposed mass{&effect("point_mass"), 0, Eigen::Vector3d(0.01, place_.x(), place_.y())};
  EXPECT_TRUE(spread_out(problem_, fit_with({mass}), catalogue).empty());
}

TEST_F(Elsewhere, IsNoPlaceForWhatHasNone) {
  EXPECT_TRUE(seen_from({&effect("sensor_gain"), 1, VectorXd::Constant(1, 0.1)}).empty());
}

}  // namespace
}  // namespace chladni::diagnosis
