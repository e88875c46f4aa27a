#include "diagnosis/verdict/verdict.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "diagnosis/fit/sensitivities.h"
#include "diagnosis/proposal.h"
#include "diagnosis/small_plate.h"
#include "diagnosis/verdict/measure_next.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Twenty thousand numbers, of which nothing but their count and their power is asked: 1e6.
class JudgedVerdict : public testing::Test {
 protected:
  JudgedVerdict() {
    observed_.outputs = observed_.inputs = 1;
    observed_.omega = VectorXd::LinSpaced(10000, 1.0, 1000.0);
    observed_.value = Eigen::MatrixXcd::Constant(10000, 1, 10.0);
    observed_.weight = Eigen::MatrixXd::Ones(10000, 1);
    found_.nothing.chi_square = 1e6;
  }

  Verdict with(std::size_t causes, double excess, double error_excess = 0.0,
               double stretch = 0.0) const {
    return with(std::vector<Cause>(causes), excess, error_excess, stretch);
  }
  Verdict with(std::vector<Cause> causes, double excess = 0.0, double error_excess = 0.0,
               double stretch = 0.0) const {
    Explanation best;
    best.causes = std::move(causes);
    best.excess = excess;
    best.error_excess = error_excess;
    best.strained = 2e4 + excess * std::sqrt(4e4) + stretch;
    return judged({small_plate(), observed_, none_}, found_, {best}, {});
  }

  // One cause with nothing left, beside another so much behind that may still gain `promise`.
  Verdict beside(double behind, double promise) const {
    Explanation best;
    best.causes.resize(1);
    best.strained = 2e4;
    Explanation rival = best;
    rival.log_evidence = -behind;
    rival.promise = promise;
    return judged({small_plate(), observed_, none_}, found_, {best, rival}, {});
  }

  Found found_;

 private:
  Observed observed_;
  std::vector<Deviation> none_;
};

TEST_F(JudgedVerdict, NamesWhatLeavesNoise) {
  for (const std::size_t causes : {1U, 2U, 3U}) {
    EXPECT_EQ(with(causes, 0.0), Verdict::named) << causes;
    EXPECT_EQ(with(causes, -3.0), Verdict::named) << causes;
    EXPECT_EQ(with(causes, 20.0), Verdict::partial) << causes;
  }
  EXPECT_EQ(with(0, 2.5), Verdict::no_discrepancy);
  EXPECT_EQ(with(0, 6.0), Verdict::unexplained);
  EXPECT_EQ(with(2, 2000.0), Verdict::unexplained);
}

// One whose fit has not converged may still become likelier than the best.
TEST_F(JudgedVerdict, CountsWhatARivalPromises) {
  const double within = kConstants.rival_within;
  EXPECT_EQ(beside(within + 1.0, 0.0), Verdict::named);
  EXPECT_EQ(beside(within - 1.0, 0.0), Verdict::ambiguous);
  EXPECT_EQ(beside(within + 1.0, 2.0), Verdict::ambiguous);
  EXPECT_EQ(beside(within + 8.0, 2.0), Verdict::named);
}

// Three causes that still leave 2.7 deviations are rarer than a thing that nobody thought of.
TEST_F(JudgedVerdict, BelievesALongStoryLess) {
  EXPECT_EQ(with(1, 2.7), Verdict::named);
  EXPECT_EQ(with(3, 2.7), Verdict::partial);
}

// Two causes that fit to the noise because ten tolerances are stretched by six and more: not told
// apart from something that nobody named.
TEST_F(JudgedVerdict, TakesStretchedTolerancesForMisfit) {
  EXPECT_EQ(with(2, 1.2), Verdict::named);
  EXPECT_EQ(with(2, 1.2, 0.0, 30.0), Verdict::named);
  EXPECT_EQ(with(2, 1.2, 0.0, 500.0), Verdict::partial);
  EXPECT_EQ(with(0, 0.0, 0.0, 30.0), Verdict::no_discrepancy);
  EXPECT_EQ(with(0, 0.0, 0.0, 1000.0), Verdict::unexplained);
}

TEST_F(JudgedVerdict, TakesErrorsOfItsOwnEffectsForNoReasonToDoubt) {
  EXPECT_EQ(with(2, 30.0), Verdict::partial);
  EXPECT_EQ(with(2, 30.0, 29.0), Verdict::named);
}

// Responses of another structure: half of its power is left, though the simulation was off by a
// hundred times as much.
TEST_F(JudgedVerdict, ExplainsNothingByWhatIsHardlyBetterThanNoResponse) {
  EXPECT_EQ(with(3, 900.0), Verdict::partial);
  found_.nothing.chi_square = 1e8;
  EXPECT_EQ(with(3, 900.0), Verdict::partial);
  EXPECT_EQ(with(3, 2500.0), Verdict::unexplained);
}

// An elastic pad is three springs to the noise, where it is.
TEST_F(JudgedVerdict, TakesManyOfAKindInOneRegionForOneThingThatItLacks) {
  const auto springs = [](double apart) {
    std::vector<Cause> all(3);
    for (auto& one : all) one.effect = "ground_spring";
    all[0].place = Eigen::Vector2d(-0.1, 0.0);
    all[1].place = Eigen::Vector2d(-0.1, apart);
    all[2].place = Eigen::Vector2d(-0.1 + apart, 0.0);
    return all;
  };
  EXPECT_EQ(with(springs(0.2)), Verdict::named);
  EXPECT_EQ(with(springs(0.05)), Verdict::partial);
  auto others = springs(0.05);
  others[1].effect = "point_mass";
  others[2].effect = "ground_damper";
  EXPECT_EQ(with(others), Verdict::named);
}

// Beside something unnamed, each of three springs in one region may be a part of it.
TEST(OfItsOwn, IsWhatIsAloneAndHardlyWhatIsOneOfManyInARegion) {
  const auto& plate = small_plate();
  std::vector<Cause> all(3);
  for (auto& one : all) one.effect = "ground_spring";
  all[0].place = Eigen::Vector2d(-0.1, 0.0);
  all[1].place = Eigen::Vector2d(-0.1, 0.01);
  all[2].place = Eigen::Vector2d(0.12, 0.05);
  EXPECT_EQ(of_its_own(plate, {all[0]}, 0), 1.0);
  EXPECT_LT(of_its_own(plate, all, 0), 0.1);
  EXPECT_EQ(of_its_own(plate, all, 0), of_its_own(plate, all, 1));
  EXPECT_GT(of_its_own(plate, all, 2), 0.7);
  all[1].effect = "point_mass";
  EXPECT_GT(of_its_own(plate, all, 0), 0.7);
  all[2].place.reset();
  EXPECT_EQ(of_its_own(plate, all, 0), 1.0);
}

// On a long body a thing is near another one by chance as the part of its length says.
TEST(ByChanceSoNear, IsThePartOfTheBodyThatIsAsNear) {
  Structure strip = small_plate();
  strip.cells.size = {1.8, 0.2};
  strip.surface.area *= 0.36 / strip.surface.area.sum();
  for (const double apart : {0.05, 0.15, 0.3, 0.6}) {
    std::vector<Cause> two(2);
    for (auto& one : two) one.effect = "point_mass";
    two[0].place = Eigen::Vector2d(0.0, 0.0);
    two[1].place = Eigen::Vector2d(apart, 0.0);
    int near = 0;
    constexpr int kAlong = 1800;
    constexpr int kAcross = 200;
    for (int n = 0; n < kAlong * kAcross; ++n) {
      const Eigen::Vector2d place(-0.9 + 1.8 * (n % kAlong + 0.5) / kAlong,
                                  -0.1 + 0.2 * (n / kAlong + 0.5) / kAcross);
      near += place.norm() < apart ? 1 : 0;
    }
    EXPECT_NEAR(by_chance_so_near(strip, two), near / static_cast<double>(kAlong * kAcross), 1e-3)
        << apart;
  }
}

// Measures a plate in which `truth` is, with 1 % of noise that is not drawn.
class Explanations : public testing::Test {
 protected:
  void measure(const std::vector<Supposed>& truth) {
    State state = state_of(plate_);
    for (const auto& cause : truth) change_of(cause, plate_)(state);
    observed_ = observed_in(state, 100.0);
  }
  Fit fit_of(std::vector<Supposed> causes) const {
    Fit start;
    start.causes = std::move(causes);
    return fitted(problem_, start);
  }
  Found found_of(std::vector<Fit> fits) const {
    Found found;
    found.nothing = fit_of({});
    found.fits = std::move(fits);
    found.fits.push_back(found.nothing);
    return found;
  }

  const Structure& plate_ = small_plate();
  Observed observed_;
  std::vector<Deviation> none_;
  Problem problem_{plate_, observed_, none_};
};

// Whichever was found first: a mass with inertia and a gain, or the gain and the mass.
TEST_F(Explanations, PutTheSimplerOfTwoThatExplainAsWellFirst) {
  const Supposed gain{&effect("sensor_gain"), 2, VectorXd::Constant(1, std::log(1.2))};
  const Supposed mass{&effect("point_mass"), 0, Eigen::Vector3d(0.04, 0.1, -0.05)};
  const Supposed wide{&effect("mass_with_inertia"), 0,
                      Eigen::Vector4d(std::log(0.04), std::log(1e-3), 0.1, -0.05)};
  measure({gain, mass});
  const Found found = found_of({fit_of({wide, gain}), fit_of({gain, mass})});
  const auto told = explanations(problem_, found, 20.0);
  ASSERT_EQ(told.front().causes.size(), 2U);
  EXPECT_EQ(told.front().causes.back().effect, "point_mass");
  EXPECT_EQ(judged(problem_, found, told, {}), Verdict::named);
}

// Two units of one sensor are two causes, and each says which it is.
TEST_F(Explanations, SayWhichUnitWasTakenForWhich) {
  const auto& unit = effect("sensor_unit");
  const auto taken = [&](std::string_view text) {
    Index option = 0;
    while (unit.channels(plate_, option) != std::vector<std::string>{"s3"} ||
           choice_of(unit, option).text != text) {
      ++option;
    }
    return Supposed{&unit, option, VectorXd(0)};
  };
  const Supposed truth = taken("g taken for m/s^2");
  measure({truth});
  const Found found = found_of({fit_of({truth}), fit_of({taken("Hz taken for rad/s")})});
  const auto told = explanations(problem_, found, 5.0);
  const Cause& best = told.front().causes.front();
  EXPECT_EQ(best.option, "g taken for m/s^2");
  EXPECT_TRUE(best.parameters.empty());
  ASSERT_EQ(best.fixed.size(), 1U);
  EXPECT_EQ(best.fixed.front().name, "factor");
  EXPECT_DOUBLE_EQ(best.fixed.front().value, 1.0 / 9.80665);
  const auto other = [](const Explanation& one) {
    return one.causes.size() == 1 && one.causes.front().option == "Hz taken for rad/s";
  };
  EXPECT_TRUE(std::ranges::any_of(told, other));  // it is not the same as the best
}

// A place and a tilt do the same in bending; what is thought of either beforehand is no evidence.
TEST_F(Explanations, ArePlacesRatherThanTilts) {
  const Supposed moved{&effect("actuator_position"), 12, Eigen::Vector2d(-2.5e-4, 2.6e-4)};
  const Supposed tilted{&effect("actuator_direction"), 12, Eigen::Vector2d(0.025, -0.026)};
  measure({moved});
  const Found found = found_of({fit_of({tilted}), fit_of({moved})});
  EXPECT_GT(found.fits[0].log_evidence, found.fits[1].log_evidence + 3.0);
  EXPECT_EQ(explanations(problem_, found, 1.0).front().causes.front().effect, "actuator_position");
}

// What is told of the next measurement.
class NextSensor : public Explanations {
 protected:
  std::string asked(const Found& found, std::optional<Verdict> verdict = {}) const {
    const auto all = explanations(problem_, found, 1.0);
    Diagnosis told;
    told.verdict = verdict.value_or(judged(problem_, found, all, {}));
    told.best = all.front();
    told.rivals.assign(all.begin() + 1, all.end());
    return measure_next(problem_, found, told);
  }
  // Σ |G_a − G_b|² / σ² at the place of the scan where it is largest, for one σ of all responses.
  double most_evidence(const Fit& a, const Fit& b, double sigma) const {
    const auto there = [&](const Fit& fit) {
      State state = state_of(problem_, fit.causes, fit.eta);
      const auto count = plate_.surface.count();
      state.outputs = plate_.surface.shapes;
      state.output_upper.setZero(count, state.output_upper.cols());
      state.residual.setZero(count, state.input_count());
      state.output_paths.assign(static_cast<std::size_t>(count), Path{});
      state.output_of.resize(static_cast<std::size_t>(count));
      for (Index i = 0; i < count; ++i) state.output_of[static_cast<std::size_t>(i)] = i;
      return responses(state, observed_.omega);
    };
    const Eigen::MatrixXd apart = (there(a) - there(b)).cwiseAbs2();
    const VectorXd of_column = apart.colwise().sum();
    const Index count = plate_.surface.count();
    return of_column.reshaped(count, plate_.input_count()).rowwise().sum().maxCoeff() /
           (sigma * sigma);
  }
};

// Against "nothing is wrong" a cause of a hundred nats needs no further sensor.
TEST_F(NextSensor, IsNoneWhereTheCauseIsSure) {
  const Supposed mass{&effect("point_mass"), 0, Eigen::Vector3d(0.04, 0.1, -0.05)};
  measure({mass});
  const Found found = found_of({fit_of({mass})});
  EXPECT_EQ(asked(found).find("nothing is left to tell apart"), 0U);
}

// Beside a partial verdict something is left, of which no such measurement tells anything.
TEST_F(NextSensor, DoesNotSayThatNothingIsLeftWhereSomethingIs) {
  const Supposed mass{&effect("point_mass"), 0, Eigen::Vector3d(0.04, 0.1, -0.05)};
  measure({mass});
  const Found found = found_of({fit_of({mass})});
  const auto told = asked(found, Verdict::partial);
  EXPECT_EQ(told.find("nothing is left"), std::string::npos) << told;
  EXPECT_NE(told.find("mend that first"), std::string::npos) << told;
}

// A mass that brings a few nats: more is to be measured, or no sensor tells it.
TEST_F(NextSensor, IsAskedForWhereTheCauseIsNotSure) {
  const Supposed mass{&effect("point_mass"), 0, Eigen::Vector3d(0.04, 0.1, -0.05)};
  measure({mass});
  observed_.weight *= 1.2e-2;
  const auto told = asked(found_of({fit_of({mass})}));
  EXPECT_NE(told.find("sensor"), std::string::npos) << told;
}

// Sensors of one noise at all lines, however small the response: one more of them tells no more
// than that noise lets it, also where the body is at rest.
TEST_F(NextSensor, HasTheNoiseOfTheOthers) {
  const Supposed mass{&effect("point_mass"), 0, Eigen::Vector3d(0.04, 0.1, -0.05)};
  measure({mass});
  const double sigma = 5e-4 * observed_.value.norm() / std::sqrt(observed_.value.size());
  observed_.weight.setConstant(std::sqrt(2.0) / sigma);
  Supposed beside = mass;
  beside.x(1) += 0.01;
  Fit a;
  Fit b;
  a.causes = {mass};
  b.causes = {beside};
  const double most = most_evidence(a, b, sigma);
  const auto told = measure_next(problem_, a, b);
  const auto figure = told.find("up to ");
  ASSERT_NE(figure, std::string::npos) << told;
  const double evidence = std::strtod(told.c_str() + figure + 6, nullptr);
  EXPECT_LE(evidence, 1.01 * most);
  EXPECT_GT(evidence, 0.5 * most);
  // An actuator that nobody drove tells nothing.
  const auto p = observed_.outputs;
  observed_.weight.rightCols(observed_.weight.cols() - p).setZero();
  const auto less = measure_next(problem_, a, b);
  EXPECT_LT(std::strtod(less.c_str() + less.find("up to ") + 6, nullptr), 0.7 * evidence) << less;
}

// A wafer is as small as a plate's rounding: its places differ by less than a millimetre.
TEST(PlaceInWords, TellsPlacesOnSmallBodiesApart) {
  EXPECT_EQ(place_in_words({0.123, -0.0502}), "(123, -50) mm");
  EXPECT_EQ(place_in_words({0.004, 0.0021}), "(4.0, 2.1) mm");
  EXPECT_EQ(place_in_words({0.000776, -0.0004}), "(0.78, -0.40) mm");
  EXPECT_EQ(place_in_words({2e-6, 0.0}), "(0.002, 0.000) mm");
  EXPECT_EQ(place_in_words({0.0, 0.0}), "(0, 0) mm");
}

}  // namespace
}  // namespace chladni::diagnosis
