#include "diagnosis/fit.h"

#include <gtest/gtest.h>

#include "diagnosis/small_plate.h"

namespace chladni::diagnosis {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Beside the rim nothing hangs on the plate: a difference across it is no slope.
TEST(Sensitivities, AreOneSidedOnTheRim) {
  const auto& plate = small_plate();
  const Observed observed = observed_in(state_of(plate), 1.0);
  const std::vector<Deviation> none;
  const Problem problem{plate, observed, none};
  const auto slopes = [&](double u) {
    const std::vector<Supposed> causes{{&effect("point_mass"), 0, Eigen::Vector3d(0.05, u, 0.07)}};
    const State state = state_of(problem, causes, VectorXd(0));
    return sensitivities(problem, causes, VectorXd(0), solved(state, Body(state, observed.omega)));
  };
  for (const double side : {-1.0, 1.0}) {
    const MatrixXd on = slopes(side * 0.3);
    const MatrixXd off = slopes(side * (0.3 - 1e-3));
    for (const int column : {0, 1, 2}) {
      EXPECT_LT((on - off).col(column).norm(), 0.05 * off.col(column).norm()) << column;
    }
  }
}

// What hangs beyond the rim: its mass moved outward along the slope of the shapes.
TEST(Fitted, GoesOnWhereAPlaceStaysOnTheRim) {
  const auto& plate = small_plate();
  Attached beyond;
  const auto motion = plate.surface.at({0.3, 0.1});
  beyond.shapes = motion->shape + 0.004 * motion->slope_u;
  beyond.mass = 0.3;
  State truth = state_of(plate);
  truth.attached.push_back(beyond);
  const Observed observed = observed_in(truth, 10.0);
  const std::vector<Deviation> none;
  Fit start;
  start.causes = {{&effect("point_mass"), 0, Eigen::Vector3d(0.2, 0.3, 0.07)}};
  const Problem problem{plate, observed, none};
  const Fit found = fitted(problem, start);
  EXPECT_TRUE(found.converged);
  EXPECT_NEAR(found.causes[0].x(0), 0.31, 0.01);  // it moves more there than on the rim
  EXPECT_NEAR(found.causes[0].x(1), 0.3, 1e-5);
  EXPECT_NEAR(found.causes[0].x(2), 0.1, 0.005);
  FitLimits none_at_all;
  none_at_all.iterations = 0;
  EXPECT_LT(found.chi_square, 1e-3 * fitted(problem, start, none_at_all).chi_square);
}

}  // namespace
}  // namespace chladni::diagnosis
