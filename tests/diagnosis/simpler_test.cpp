// What is simpler is meant where a pole is not seen, and a further cause pays beyond what errors of
// the others may leave.
#include "diagnosis/search/simpler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>

#include "diagnosis/small_plate.h"
#include "diagnosis/verdict/verdict.h"
#include "rotation/turn.h"
#include "simulators/tables/loaded_table.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

Supposed resonator(double mass, double hz, double damping_ratio) {
  VectorXd x(5);
  x << std::log(mass), std::log(hz), std::log(damping_ratio), 0.1, -0.05;
  return {&effect("resonator"), 0, x};
}

// A plate in which a resonator is, with 1 % of noise; what a search that found it comes to.
class Pole : public testing::Test {
 protected:
  std::vector<Explanation> told(const Supposed& truth, std::vector<Supposed> beside = {}) {
    State state = state_of(plate_);
    change_of(truth, plate_)(state);
    for (const auto& one : beside) change_of(one, plate_)(state);
    observed_ = with_noise(observed_in(state, 100.0), 3);
    found_.nothing = fitted(problem_, Fit{});
    Fit start;
    start.causes = {truth};
    start.causes.insert(start.causes.end(), beside.begin(), beside.end());
    found_.fits = {fitted(problem_, start), found_.nothing};
    add_simpler(problem_, found_, 5.0);
    return explanations(problem_, found_, 5.0);
  }

  const Structure& plate_ = small_plate();
  Observed observed_;
  std::vector<Deviation> none_;
  Problem problem_{plate_, observed_, none_};
  Found found_;
};

// The body is 30 % stiffer, which a tolerance has at one deviation. Without the cause that says so,
// its resonances lie many widths off, and no descent from there finds them.
TEST(Without, IsNoWorseThanNoCauseAtAll) {
  const auto& plate = small_plate();
  const auto& modulus = effect("youngs_modulus");
  const auto stiffer = [&](double by) { return Supposed{&modulus, 0, VectorXd::Constant(1, by)}; };
  const std::vector<Deviation> tolerance{{"modulus", [&](State& state, double eta) {
                                            modulus.apply(state, plate, 0,
                                                          VectorXd::Constant(1, 0.3 * eta));
                                          }}};
  State state = state_of(plate);
  change_of(stiffer(0.3), plate)(state);
  const Observed observed = observed_in(state, 100.0);
  const Problem problem{plate, observed, tolerance};
  Fit start;
  start.eta = VectorXd::Ones(1);
  const Fit nothing = fitted(problem, start);
  ASSERT_NEAR(nothing.objective, 0.5, 1e-3);
  start.eta = VectorXd::Zero(1);
  start.causes = {stiffer(0.3), {&effect("sensor_gain"), 0, VectorXd::Constant(1, 0.01)}};
  const Fit less = without(problem, fitted(problem, start), 0, nothing);
  ASSERT_EQ(less.causes.size(), 1U);
  EXPECT_LT(0.5 * less.strained(), 1.0);
}

// As a mass looks that hangs on a place softer than the mesh has it.
TEST_F(Pole, IsAMassFarAboveTheBand) {
  const auto all = told(resonator(0.2, 2800.0, 0.5));
  const auto& best = all.front();
  ASSERT_EQ(best.causes.size(), 1U);
  EXPECT_EQ(best.causes.front().effect, "point_mass");
  EXPECT_NEAR(best.causes.front().parameters.front().value, 0.2, 0.02);  // more toward the pole
  EXPECT_GT(best.causes.front().probability, 0.9);
  EXPECT_EQ(judged(problem_, found_, all, {}), Verdict::named);
  // The pole itself is many deviations beyond luck.
  const auto& general = found_.fits.front();
  EXPECT_EQ(general.causes.front().effect->name, "resonator");
  EXPECT_GT(general.log_evidence - found_.fits[best.fit].log_evidence, 5.0);
}

TEST_F(Pole, IsAMassWhereItIsDampedAway) {
  const auto all = told(resonator(0.2, 3300.0, 3.3));
  EXPECT_EQ(all.front().causes.front().effect, "point_mass");
}

TEST_F(Pole, IsASpringFarBelowTheBand) {
  const double hz = 4.6;
  const auto all = told(resonator(112.0, hz, 2e-4));
  ASSERT_EQ(all.front().causes.size(), 1U);
  EXPECT_EQ(all.front().causes.front().effect, "ground_spring");
  const double stiffness = 112.0 * std::pow(2.0 * std::numbers::pi * hz, 2);
  EXPECT_NEAR(all.front().causes.front().parameters.front().value, stiffness, 0.05 * stiffness);
}

// What mends the poorer cause is nothing beside the simpler one in its place.
TEST_F(Pole, TakesWithItWhatMendedIt) {
  const double stiffness = 62e3;
  VectorXd x(3);
  x << std::log(stiffness), 0.1, -0.05;
  (void)told({&effect("ground_spring"), 0, x});
  const double hz = 19.0;
  Fit start;
  start.causes = {resonator(stiffness / std::pow(2.0 * std::numbers::pi * hz, 2), hz, 1e-3),
                  resonator(1e-3, 24.0, 0.01)};
  Fit poor = fitted(problem_, start);
  poor.less = {found_.nothing, found_.nothing};  // as if each were worth its evidence
  found_.fits = {std::move(poor), found_.nothing};
  trim(problem_, found_, {}, 5.0);
  const auto all = explanations(problem_, found_, 5.0);
  ASSERT_EQ(all.front().causes.size(), 1U);
  EXPECT_EQ(all.front().causes.front().effect, "ground_spring");
  for (const auto& one : all) {
    for (const auto& cause : one.causes) EXPECT_GT(cause.log_evidence_gain, 0.0) << cause.effect;
  }
}

TEST_F(Pole, IsOneWithinTheBand) {
  const auto all = told(resonator(0.05, 240.0, 0.02));
  EXPECT_EQ(all.front().causes.front().effect, "resonator");
}

// With a dashpot that outweighs its spring it is neither a spring nor a damper alone.
TEST_F(Pole, IsOneFarBelowTheBandWhereItsDashpotShows) {
  EXPECT_EQ(told(resonator(112.0, 4.6, 0.02)).front().causes.front().effect, "resonator");
}

// Two at once, each for what it is.
TEST_F(Pole, IsExchangedBesideAnother) {
  Supposed low = resonator(112.0, 4.6, 2e-4);
  low.x(3) = -0.18;
  const auto all = told(resonator(0.2, 2800.0, 0.5), {low});
  ASSERT_EQ(all.front().causes.size(), 2U);
  const auto named = [&](std::string_view name) {
    return std::ranges::any_of(all.front().causes,
                               [&](const Cause& cause) { return cause.effect == name; });
  };
  EXPECT_TRUE(named("point_mass"));
  EXPECT_TRUE(named("ground_spring"));
}

// --- A further cause.

class FurtherCause : public testing::Test {
 protected:
  // One that brings so much beside another that explains a million.
  bool is_believed(const Supposed& first, double brings, double solver_error) const {
    const Problem problem{plate_, observed_, none_, solver_error};
    Fit nothing;
    nothing.objective = 1e6;
    nothing.converged = true;
    Fit less = nothing;
    less.causes = {first};
    less.objective = 0.0;
    Fit more = less;
    more.log_evidence = less.log_evidence + brings;
    return is_sure(problem, {}, nothing, less, more);
  }

  const Structure& plate_ = small_plate();
  Observed observed_;
  std::vector<Deviation> none_;
};

TEST_F(FurtherCause, PaysBeyondWhatAnotherSolverLeavesOfTheFirst) {
  const Supposed mass{&effect("point_mass"), 0, Eigen::Vector3d(0.2, 0.1, 0.0)};
  EXPECT_TRUE(is_believed(mass, 60.0, 0.0));
  EXPECT_FALSE(is_believed(mass, 60.0, 0.01));
  EXPECT_TRUE(is_believed(mass, 200.0, 0.01));
  const Supposed moved{&effect("sensor_position"), 0, Eigen::Vector2d(0.015, 0.0)};
  EXPECT_FALSE(is_believed(moved, 60.0, 0.01));
  const Supposed sign{&effect("sensor_sign"), 0, VectorXd(0)};  // no shape of the body matters
  EXPECT_TRUE(is_believed(sign, 60.0, 0.01));
}

// A spring on a table of other polynomials, whose modes are damped as they are loaded.
TEST_F(FurtherCause, IsNotAddedToASpringOfAnotherModel) {
  EVERY_FOURTH_LANDING();
  simulators::LoadedTable table;
  table.spring = 62e3;
  table.foot = {-0.15, 0.11};
  table.noise = 0.01;
  table.lines = 80;
  table.high_hz = 700.0;
  const auto measured = simulators::loaded_table(simulators::believed_table(10), table);
  DiagnosisOptions options;
  options.lines = 60;
  options.only = {"ground_spring", "ground_damper",      "resonator",
                  "point_mass",    "actuator_crosstalk", "suspension"};
  const auto diagnosis = diagnosed(plate_of(30, 15), measured, options);
  EXPECT_EQ(diagnosis.verdict, Verdict::named) << diagnosis.best.excess;
  ASSERT_EQ(diagnosis.best.causes.size(), 1U) << diagnosis.best.causes.back().effect;
  const Cause& spring = diagnosis.best.causes.front();
  EXPECT_EQ(spring.effect, "ground_spring");
  EXPECT_NEAR(spring.parameters.front().value, 62e3, 3.0 * spring.parameters.front().std);
  EXPECT_GT(spring.probability, 0.9);
}

}  // namespace
}  // namespace chladni::diagnosis
