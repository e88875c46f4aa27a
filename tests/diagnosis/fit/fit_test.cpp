#include "diagnosis/fit/fit.h"

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

// A mass far from its place: what is told is of where the fit ended, and whether it could go on.
TEST(Fitted, TellsWhereItEndsAndWhetherItCouldGoOn) {
  const auto& plate = small_plate();
  State truth = state_of(plate);
  effect("point_mass").apply(truth, plate, 0, Eigen::Vector3d(0.3, 0.1, 0.07));
  const Observed observed = observed_in(truth, 100.0);
  const std::vector<Deviation> none;
  const Problem problem{plate, observed, none};
  Fit start;
  start.causes = {{&effect("point_mass"), 0, Eigen::Vector3d(0.15, 0.08, 0.09)}};
  FitLimits standing;
  standing.iterations = 0;
  for (const int iterations : {1, 2, 3, 30}) {
    FitLimits limits;
    limits.iterations = iterations;
    const Fit fit = fitted(problem, start, limits);
    const Fit there = fitted(problem, fit, standing);
    EXPECT_NEAR(fit.log_evidence, there.log_evidence, 0.1) << iterations;
    EXPECT_NEAR(fit.promise, there.promise, 0.1 + 1e-6 * there.promise) << iterations;
    EXPECT_EQ(fit.converged, iterations == 30) << fit.promise;
    EXPECT_EQ(fit.converged, fit.promise < kConstants.nothing_more);
  }
}

// Evidence that has not been reached counts for those that may reach it, within bounds.
TEST(Fitted, MayBeBetterThanItIs) {
  Fit fit;
  fit.log_evidence = 10.0;
  fit.promise = 3.0;
  EXPECT_EQ(fit.evidence_at_best(), 13.0);
  fit.promise = 1e6;
  EXPECT_EQ(fit.evidence_at_best(), 18.0);
  fit.converged = true;
  EXPECT_EQ(fit.evidence_at_best(), 10.0);
}

// Two causes in one place that do the same: what tells them apart is below the rounding of the
// data.
TEST(Fitted, EndsWhereTwoCausesAreOne) {
  VectorXd x(3);
  x << std::log(0.05), 0.083, -0.127;
  const Supposed mass{&effect("point_mass"), 0, x};
  State state = state_of(small_plate());
  for (int n = 0; n < 2; ++n) change_of(mass, small_plate())(state);
  const Observed observed = observed_in(state, 1e9);
  const std::vector<Deviation> none;
  Fit start;
  start.causes = {mass, mass};
  const Fit found = fitted({small_plate(), observed, none}, start);
  EXPECT_TRUE(std::isfinite(found.log_evidence));
  EXPECT_TRUE(found.covariance.allFinite());
  EXPECT_GT(found.covariance.diagonal().minCoeff(), 0.0);
}

// Exact data of the plate itself. Where a mass of nothing lies is not known, and its place is all
// over the surface: the mass explains nothing, and has the evidence of nothing or less. A place
// that were wider than the surface would bring evidence without end.
TEST(Fitted, HasNoEvidenceForWhatDoesNothing) {
  const auto& plate = small_plate();
  const Observed observed = observed_in(state_of(plate), 100.0);
  const std::vector<Deviation> none;
  const Problem problem{plate, observed, none};
  const Fit nothing = fitted(problem, Fit{});
  FitLimits standing;
  standing.iterations = 0;
  for (const double mass : {0.0, 1e-12, 1e-9, 1e-6}) {
    Fit start;
    start.causes = {{&effect("point_mass"), 0, Eigen::Vector3d(mass, 0.1, 0.07)}};
    const Fit fit = fitted(problem, start, standing);
    EXPECT_TRUE(std::isfinite(fit.log_evidence)) << mass;
    EXPECT_LT(fit.log_evidence, nothing.log_evidence) << mass;
    EXPECT_TRUE(fit.covariance.allFinite()) << mass;
    EXPECT_LE(std::sqrt(fit.covariance(1, 1)), plate.surface.size()) << mass;
  }
}

}  // namespace
}  // namespace chladni::diagnosis
