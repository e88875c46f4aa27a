#include "diagnosis/fit/fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "diagnosis/fit/deviations.h"
#include "diagnosis/fit/information.h"
#include "diagnosis/fit/sensitivities.h"
#include "diagnosis/search/quadratic.h"
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

// Beside causes the slopes of the deviations alone are those of all, column by column.
TEST(Sensitivities, OfTheDeviationsAloneAreTheLastOfAll) {
  const auto& plate = small_plate();
  Tolerances some = no_tolerances();
  some.gain = 5e-3;
  some.modulus = 5e-3;
  const auto free = deviations(plate, some, 800.0);
  const Observed observed = observed_in(state_of(plate), 1.0);
  const Problem problem{plate, observed, free};
  const std::vector<Supposed> causes{{&effect("point_mass"), 0, Eigen::Vector3d(0.6, 0.1, 0.07)},
                                     {&effect("sensor_gain"), 1, VectorXd::Constant(1, 0.7)}};
  const VectorXd eta = VectorXd::LinSpaced(std::ssize(free), -1.0, 1.0);
  const State state = state_of(problem, causes, eta);
  const Solved now = solved(state, Body(state, observed.omega));
  const MatrixXd all = sensitivities(problem, causes, eta, now);
  ASSERT_EQ(all.cols(), 4 + eta.size());
  EXPECT_EQ(sensitivities_of_deviations(problem, causes, eta, now),
            MatrixXd(all.rightCols(eta.size())));
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

// One response about one resonance tells only how far a mass moved it: mass and place together.
class OneResonance : public testing::Test {
 protected:
  OneResonance() {
    plate_.outputs = part_of(plate_.outputs, {0});
    plate_.inputs = part_of(plate_.inputs, {0});
    plate_.residual = Eigen::MatrixXd(plate_.residual.topLeftCorner(1, 1));
    observed_.outputs = observed_.inputs = 1;
    const double first = 2.0 * std::numbers::pi * plate_.frequency_hz(plate_.rigid_count);
    observed_.omega = VectorXd::LinSpaced(7, 0.97 * first, first);
    State truth = state_of(plate_);
    effect("point_mass").apply(truth, plate_, 0, kTruth);
    observed_.value = responses(truth, observed_.omega);
    observed_.weight = observed_.value.cwiseAbs().cwiseInverse();
  }
  // Likelihood and prior on a grid of masses and places, n of each: χ² and ln of the density times
  // the volume of a point.
  struct Grid {
    Eigen::ArrayXd chi_square, prior;
  };
  Grid grid(int n) const {
    const auto mass = effect("point_mass").parameters(plate_).front();
    const Eigen::Array3d from(mass.centre - 5.0 * mass.width, plate_.cells.from(0),
                              plate_.cells.from(1));
    const Eigen::Array3d side(10.0 * mass.width, plate_.cells.size(0), plate_.cells.size(1));
    Grid made{Eigen::ArrayXd(n * n * n), Eigen::ArrayXd(n * n * n)};
    for (int k = 0; k < n * n * n; ++k) {
      const Eigen::Array3d step(k / (n * n), k / n % n, k % n);
      const Supposed there{&effect("point_mass"), 0, from + side * (step + 0.5) / n};
      State state = state_of(plate_);
      there.effect->apply(state, plate_, 0, there.x);
      made.chi_square(k) = residual(observed_, responses(state, observed_.omega)).squaredNorm();
      made.prior(k) = log_prior(there, plate_) + (side / n).log().sum();
    }
    return made;
  }

  inline static const Eigen::Vector3d kTruth{0.3, 0.11, 0.07};
  Structure plate_ = small_plate();
  Observed observed_;
};

// Along the line of places where masses of one and the same size do the same, the place is as wide
// as the plate, not as a tangent.
TEST_F(OneResonance, HasNoMoreEvidenceThanTheIntegralOverThePlate) {
  const auto all = grid(26);
  const VectorXd unit = observed_.weight;
  const std::vector<Deviation> none;
  const Problem problem{plate_, observed_, none};
  Fit start;
  start.causes = {{&effect("point_mass"), 0, kTruth}};
  for (const double weight : {1.0, 3.0, 10.0}) {
    observed_.weight = weight * unit;
    const Fit fit = fitted(problem, start);
    const double integral =
        std::log((all.prior - 0.5 * weight * weight * all.chi_square).exp().sum());
    EXPECT_LT(fit.log_evidence, integral + 0.5) << weight;
    EXPECT_GT(fit.log_evidence, integral - 2.0) << weight;  // other places explain as much
    const auto parameters = effect("point_mass").parameters(plate_);
    for (const int i : {1, 2}) {
      const double width = prior_width(plate_, parameters[static_cast<std::size_t>(i)]);
      EXPECT_LE(std::sqrt(fit.covariance(i, i)), width) << weight;
    }
  }
}

// A gain of which the data want more than is plausible: the fit ends where the plausible ends and
// can gain nothing more, and its evidence is the integral up to there.
TEST(Fitted, HasTheEvidenceOfWhatIsPlausible) {
  const auto& plate = small_plate();
  const auto& gain = effect("sensor_gain");
  const auto parameter = gain.parameters(plate).front();
  const auto [low, high] = parameter.ends();
  const std::vector<Deviation> none;
  for (const double weight : {3.0, 10.0, 100.0}) {
    for (const double beyond : {0.0, 0.05, 0.3}) {
      const double wanted = high + beyond;
      State truth = state_of(plate);
      truth.output_paths[2].gain = std::exp(wanted);
      const Observed observed = observed_in(truth, weight);
      Fit start;
      start.causes = {{&gain, 2, VectorXd::Constant(1, 0.9 * high)}};
      const Fit fit = fitted({plate, observed, none}, start);
      const double values = static_cast<double>(observed.line_count() * observed.inputs);
      const auto density = [&](double x) {
        const double off = (x - parameter.centre) / parameter.width;
        const double chi_square = values * std::pow(weight * -std::expm1(x - wanted), 2);
        return std::exp(-0.5 * chi_square - 0.5 * off * off - fit.log_evidence) /
               (parameter.width * std::sqrt(2.0 * std::numbers::pi) *
                static_cast<double>(gain.options(plate)));
      };
      constexpr int kPoints = 100000;  // the nearer to the end the denser
      double sum = 0.0;
      for (int n = 0; n < kPoints; ++n) {
        const double t = (n + 0.5) / kPoints;
        sum += 4.0 * std::pow(t, 3) * density(high - (high - low) * std::pow(t, 4));
      }
      EXPECT_NEAR(std::log(sum * (high - low) / kPoints), 0.0, 0.1) << weight << ' ' << beyond;
      EXPECT_TRUE(fit.converged) << weight << ' ' << beyond;
      EXPECT_EQ(fit.evidence_at_best(), fit.log_evidence);
    }
  }
}

TEST(PartBeforeAnEnd, IsThatOfTheIntegral) {
  const double normal = std::sqrt(2.0 * std::numbers::pi);
  const auto part = [](double distance, double slope, double deviation) {
    return log_part_before_an_end({distance, slope, deviation});
  };
  EXPECT_NEAR(part(0.0, 0.0, 0.7), std::log(0.5), 1e-12);
  EXPECT_NEAR(part(9.0, 0.0, 0.7), 0.0, 1e-12);
  EXPECT_NEAR(part(0.0, 2e6, 3.0), -std::log(6e6 * normal), 1e-9);  // ∫ exp(−slope u)
  const double far = 20.0 * std::numbers::sqrt2;
  EXPECT_NEAR(part(0.0, far * (1.0 - 1e-9), 1.0), part(0.0, far * (1.0 + 1e-9), 1.0), 1e-5);
  for (const auto& [distance, slope] :
       {std::pair(0.0, -1.0), std::pair(0.0, 0.3), std::pair(0.0, 4.0), std::pair(0.6, 0.0)}) {
    double sum = 0.0;
    for (double u = 5e-5 - distance; u < 12.0; u += 1e-4) {
      sum += 1e-4 * std::exp(-slope * u - 0.5 * u * u);
    }
    EXPECT_NEAR(part(distance, slope, 1.0), std::log(sum / normal), 1e-6) << slope;
  }
}

// Beside a cause the tolerances do what they do beside it: against differences of the responses.
TEST(ToleratedVariance, IsThatOfTheStateWithItsCauses) {
  const auto& plate = small_plate();
  Tolerances some = no_tolerances();
  some.gain = 5e-3;
  some.modulus = 5e-3;
  const auto free = deviations(plate, some, 800.0);
  Fit fit;
  fit.causes = {{&effect("point_mass"), 0, Eigen::Vector3d(0.6, 0.1, 0.07)},
                {&effect("sensor_gain"), 1, VectorXd::Constant(1, 0.7)}};
  fit.eta = VectorXd::Zero(std::ssize(free));
  const Observed observed = observed_in(state_of(plate), 100.0);
  const Problem problem{plate, observed, free};
  const auto at = [&](double eta, Eigen::Index i) {
    const VectorXd there = eta * VectorXd::Unit(fit.eta.size(), i);
    return responses(state_of(problem, fit.causes, there), observed.omega);
  };
  MatrixXd truth = MatrixXd::Zero(observed.value.rows(), observed.value.cols());
  for (Eigen::Index i = 0; i < fit.eta.size(); ++i) {
    truth += ((at(1e-3, i) - at(-1e-3, i)) / 2e-3).cwiseAbs2();
  }
  const State state = state_of(problem, fit.causes, fit.eta);
  const MatrixXd told =
      tolerated_variance(problem, fit, solved(state, Body(state, observed.omega)));
  EXPECT_LT((told - truth).norm(), 1e-3 * truth.norm());
}

// A place that nothing tells of is somewhere on the body: as wide each way as the body.
TEST(PriorWidth, OfAPlaceHasTheSidesOfTheBody) {
  Structure plate = small_plate();
  const double area = plate.surface.area.sum();
  const auto width = [&](int coordinate) {
    const auto parameters = effect("point_mass").parameters(plate);
    return prior_width(plate, parameters[static_cast<std::size_t>(coordinate)]);
  };
  EXPECT_NEAR(width(1), std::sqrt(area / (2.0 * std::numbers::pi)), 1e-12);
  EXPECT_NEAR(width(2), width(1), 1e-12);
  plate.cells.size = {1.8, 0.2};
  EXPECT_NEAR(width(1), 9.0 * width(2), 1e-12);
  EXPECT_NEAR(2.0 * std::numbers::pi * width(1) * width(2), area, 1e-12);
  plate.cells.size.setZero();  // the places of the scan have the same sides
  plate.surface.places.col(1) *= 0.25;
  EXPECT_NEAR(width(1), 4.0 * width(2), 1e-12);
  EXPECT_NEAR(2.0 * std::numbers::pi * width(1) * width(2), area, 1e-12);
}

}  // namespace
}  // namespace chladni::diagnosis
