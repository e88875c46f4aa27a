#include "diagnosis/search/starts.h"

#include <gtest/gtest.h>

#include <cmath>

#include "diagnosis/fit/fit.h"
#include "diagnosis/small_plate.h"

namespace chladni::diagnosis {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;

// Every response to within a per mille of its size.
Observed seen_with(const Supposed& cause, const Structure& plate) {
  State state = state_of(plate);
  cause.effect->apply(state, plate, cause.option, cause.x);
  return observed_in(state, 1e3);
}

// The scan's places are 15 mm apart; the valley of a stiff spring is narrower.
TEST(BestStarts, LeadToAStiffSpringBetweenThePlacesOfTheScan) {
  const auto plate = plate_of(48, 41);
  for (const Vector2d& place :
       {Vector2d(-0.1085, 0.052), Vector2d(0.155, -0.222), Vector2d(0.052, 0.022),
        Vector2d(-0.23, 0.247), Vector2d(0.067, -0.128), Vector2d(0.007, 0.187),
        Vector2d(-0.172, -0.082), Vector2d(0.252, 0.006)}) {
    const Eigen::Vector3d truth(std::log(2e6), place(0), place(1));
    const auto observed = seen_with({&effect("ground_spring"), 0, truth}, plate);
    const Scene scene(plate, observed, state_of(plate),
                      MatrixXd::Zero(observed.value.rows(), observed.value.cols()));
    const auto starts = best_starts(scene, effect("ground_spring"));
    ASSERT_FALSE(starts.empty());
    const std::vector<Deviation> none;
    Fit start;
    start.causes = {starts.front().cause};
    start.eta = Eigen::VectorXd(0);
    const Fit found = fitted({plate, observed, none}, start, {16, 0.3, HUGE_VAL});
    EXPECT_LT((found.causes.front().x.tail<2>() - place).norm(), 1e-4)
        << place.transpose() << " starts at " << starts.front().cause.x.transpose();
    EXPECT_NEAR(found.causes.front().x(0), truth(0), 1e-3);
  }
}

TEST(BestStarts, AreOfDifferentPlaces) {
  const auto& plate = small_plate();
  const auto observed =
      seen_with({&effect("point_mass"), 0, Eigen::Vector3d(0.03, 0.1, 0.05)}, plate);
  const Scene scene(plate, observed, state_of(plate),
                    MatrixXd::Zero(observed.value.rows(), observed.value.cols()));
  const auto starts = best_starts(scene, effect("point_mass"));
  ASSERT_EQ(starts.size(), 2U);
  EXPECT_LE(starts[0].misfit, scene.misfit());
  EXPECT_NEAR(starts[0].cause.x(0), 0.03, 1e-3);
}

// The cheap way to a misfit sees what the modes above the band do.
TEST(Misfits, OfTheModesAboveAreThoseOfTheirResponses) {
  const auto& plate = small_plate();
  const Supposed truth{&effect("modes_above"), 0, Eigen::VectorXd::Constant(1, std::log(2.5))};
  const auto observed = seen_with(truth, plate);
  const Scene scene(plate, observed, state_of(plate),
                    MatrixXd::Zero(observed.value.rows(), observed.value.cols()));
  ASSERT_TRUE(scene.is_cheap(truth));
  const auto starts = truth.effect->starts(scene);
  const auto misfits = scene.misfits(*truth.effect, starts);
  for (std::size_t n = 0; n < starts.size(); ++n) {
    State changed = state_of(plate);
    truth.effect->apply(changed, plate, 0, starts[n].x);
    const Eigen::MatrixXcd rest = observed.value - responses(changed, observed.omega);
    const double full = (rest.cwiseAbs().array() * scene.observed().weight.array()).square().sum();
    EXPECT_NEAR(misfits(static_cast<Eigen::Index>(n)), full, 1e-6 * scene.misfit()) << n;
  }
  EXPECT_LT(misfits.minCoeff(), 1e-3 * scene.misfit());
}

}  // namespace
}  // namespace chladni::diagnosis
