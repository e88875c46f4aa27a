#include "diagnosis/search/search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <string_view>

#include "base/draw.h"
#include "diagnosis/fit/sensitivities.h"
#include "diagnosis/search/overlap.h"
#include "diagnosis/search/simpler.h"
#include "diagnosis/small_plate.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Each response with 1 % of noise.
Observed noisy(const Structure& plate, const std::vector<Supposed>& causes, unsigned seed) {
  Observed observed;
  observed.outputs = plate.output_count();
  observed.inputs = plate.input_count();
  observed.omega = 2.0 * 3.14159265358979 * VectorXd::LinSpaced(60, 31.0, 893.0);
  const std::vector<Deviation> none;
  const State state = state_of({plate, observed, none}, causes, VectorXd(0));
  observed.value = responses(state, observed.omega);
  const Eigen::MatrixXd sigma = 0.01 * observed.value.cwiseAbs();
  observed.weight = std::sqrt(2.0) * sigma.cwiseInverse();
  Draw draw(seed);
  for (Index i = 0; i < observed.value.size(); ++i) {
    const double real = draw.normal();
    observed.value.data()[i] +=
        std::sqrt(0.5) * sigma.data()[i] * std::complex<double>(real, draw.normal());
  }
  return observed;
}

Found found_in(const Structure& plate, const Observed& observed,
               std::initializer_list<std::string_view> names) {
  std::vector<const Effect*> catalogue;
  for (const auto name : names) catalogue.push_back(&effect(name));
  const std::vector<Deviation> none;
  return searched({plate, observed, none}, catalogue, {});
}

bool has(const Fit& fit, std::string_view name) {
  return std::ranges::any_of(fit.causes,
                             [&](const Supposed& cause) { return cause.effect->name == name; });
}

// A gain of 0.5 %, six of its deviations, moves chi-square by a tenth of its own spread: what is
// left beside the sign is noise to the eye.
TEST(Search, FindsASmallCauseBesideALargeOne) {
  const auto& plate = small_plate();
  const auto observed = noisy(plate,
                              {{&effect("sensor_sign"), 1, VectorXd(0)},
                               {&effect("sensor_gain"), 2, VectorXd::Constant(1, std::log(1.005))}},
                              1);
  const auto found = found_in(plate, observed, {"sensor_sign", "sensor_gain", "point_mass"});
  const Fit& best = found.fits.front();
  ASSERT_EQ(best.causes.size(), 2U);
  EXPECT_TRUE(has(best, "sensor_sign"));
  ASSERT_TRUE(has(best, "sensor_gain"));
}

TEST(Search, AddsNothingSmallWhereNothingIs) {
  const auto& plate = small_plate();
  for (const unsigned seed : {2U, 3U, 4U}) {
    const auto observed = noisy(plate, {{&effect("sensor_sign"), 1, VectorXd(0)}}, seed);
    const auto found =
        found_in(plate, observed, {"sensor_sign", "sensor_gain", "sensor_delay", "youngs_modulus"});
    EXPECT_EQ(found.fits.front().causes.size(), 1U) << seed;
  }
}

// A delay of a few microseconds and a low-pass are one to first order, whichever came first.
TEST(Search, KeepsTheTwinOfACauseAsItsRival) {
  const auto& plate = small_plate();
  const VectorXd frame =
      (VectorXd(3) << std::log(2460.0), std::log(250.0), std::log(0.017)).finished();
  const auto observed = noisy(
      plate,
      {{&effect("frame"), 0, frame}, {&effect("sensor_delay"), 0, VectorXd::Constant(1, 7.5e-6)}},
      5);
  const auto found =
      found_in(plate, observed, {"frame", "sensor_delay", "sensor_low_pass", "sensor_gain"});
  const double best = found.fits.front().log_evidence;
  const auto within = [&](std::string_view name) {
    return std::ranges::any_of(found.fits, [&](const Fit& fit) {
      return has(fit, "frame") && has(fit, name) && fit.log_evidence > best - 5.0;
    });
  };
  EXPECT_TRUE(within("sensor_delay"));
  EXPECT_TRUE(within("sensor_low_pass"));
}

// The scan for places sees springs, to first order: its peaks lie beside a pad that is stiff. This
// one was told as a resonator and a mass.
TEST(Search, FindsAStiffPadFromTheSpringInItsMiddle) {
  const auto& plate = small_plate();
  const Eigen::Vector2d place(0.02, 0.05);
  const Eigen::Vector4d pad(std::log(1.4e6), std::log(0.12), place.x(), place.y());
  const auto observed = noisy(plate, {{&effect("elastic_pad"), 0, pad}}, 7);
  const auto found =
      found_in(plate, observed,
               {"elastic_pad", "ground_spring", "ground_damper", "resonator", "point_mass",
                "sensor_gain", "overall_gain", "frame", "local_stiffness"});
  const Fit& best = found.fits.front();
  ASSERT_EQ(best.causes.size(), 1U);
  ASSERT_TRUE(has(best, "elastic_pad"));
  EXPECT_LT((best.causes.front().x.tail(2) - place).norm(), 2e-3);
}

// A mass with a radius that the data do not ask for.
TEST(Search, TriesTheSimplerEffectInTheEnd) {
  const auto& plate = small_plate();
  const auto observed =
      noisy(plate, {{&effect("point_mass"), 0, Eigen::Vector3d(0.04, 0.1, -0.05)}}, 6);
  const std::vector<Deviation> none;
  const Problem problem{plate, observed, none};
  Found found;
  found.nothing = fitted(problem, Fit{});
  Fit start;
  start.causes = {{&effect("mass_with_inertia"), 0,
                   Eigen::Vector4d(std::log(0.04), std::log(0.01), 0.1, -0.05)}};
  found.fits = {fitted(problem, start), found.nothing};
  add_simpler(problem, found, 5.0);
  ASSERT_EQ(found.fits.size(), 3U);
  const Fit& simpler = found.fits[1];
  ASSERT_TRUE(has(simpler, "point_mass"));
  EXPECT_NEAR(simpler.causes.front().x(0), 0.04, 2e-3);
  EXPECT_GT(simpler.log_evidence, found.fits.front().log_evidence - 5.0);
}

TEST(Search, HasASimplerEffectThatTakesOverWhatBothShare) {
  const auto& plate = small_plate();
  for (const auto* general : effects()) {
    if (general->simpler.empty()) continue;
    VectorXd x(static_cast<Index>(general->parameters(plate).size()));
    for (Index i = 0; i < x.size(); ++i) x(i) = 0.01 * static_cast<double>(i + 1);
    const Supposed whole{general, 0, x};
    const auto all = simplified(whole, plate);
    ASSERT_EQ(all.size(), general->simpler.size()) << general->name;
    for (const auto& simpler : all) {
      EXPECT_EQ(static_cast<std::size_t>(simpler.x.size()),
                simpler.effect->parameters(plate).size());
      EXPECT_EQ(place_of(simpler, plate), place_of(whole, plate)) << general->name;
    }
  }
  EXPECT_TRUE(simplified({&effect("density"), 0, VectorXd::Zero(1)}, plate).empty());
}

// A fit of nothing that ended early: from where a rival has the tolerances it goes on.
TEST(Search, FitsNothingAsWellAsItsRivals) {
  const auto& plate = small_plate();
  Tolerances tolerances = no_tolerances();
  tolerances.modulus = 5e-3;
  tolerances.frequency = 1e-3;
  const auto tolerable = deviations(plate, tolerances, 900.0);
  Observed observed = noisy(plate, {}, 9);
  State truth = state_of(plate);
  for (const auto& one : tolerable) one.apply(truth, 1.5);
  observed.value = responses(truth, observed.omega);
  const Problem problem{plate, observed, tolerable};
  Fit rest;
  rest.eta = VectorXd::Zero(std::ssize(tolerable));
  FitLimits short_of_it;
  short_of_it.iterations = 1;
  const Fit early = fitted(problem, rest, short_of_it);
  EXPECT_FALSE(early.converged);
  Fit rival;
  rival.causes = {{&effect("sensor_sign"), 1, VectorXd(0)}};
  rival.eta = VectorXd::Constant(std::ssize(tolerable), 1.5);
  const Fit nothing = nothing_beside(problem, early, rival);
  EXPECT_TRUE(nothing.converged);
  EXPECT_TRUE(nothing.causes.empty());
  EXPECT_LT(nothing.objective, early.objective - 1.0);
  EXPECT_EQ(nothing_beside(problem, nothing, rest).objective, nothing.objective);
}

// Resonances by 5 % and masses by 4 % off: no response at all would be nearer to the data, and what
// makes responses smaller explains more than either cause alone.
TEST(Search, IsNotLostWhereTwoLargeCausesHideEachOther) {
  const auto& plate = small_plate();
  const auto observed = noisy(plate,
                              {{&effect("thickness"), 0, VectorXd::Constant(1, std::log(0.947))},
                               {&effect("point_mass"), 0, Eigen::Vector3d(0.8, -0.076, 0.282)}},
                              7);
  const auto found = found_in(plate, observed,
                              {"thickness", "point_mass", "youngs_modulus", "sensor_unit",
                               "sensor_gain", "overall_gain", "modal_damping"});
  const Fit& best = found.fits.front();
  ASSERT_EQ(best.causes.size(), 2U);
  EXPECT_TRUE(has(best, "thickness"));
  EXPECT_TRUE(has(best, "point_mass"));
}

// The gains of two sensors are two causes, that of one sensor is one; a mass may hang by a spring.
TEST(Search, KnowsWhatAFitAlreadyHas) {
  const auto& plate = small_plate();
  const Eigen::VectorXd size = Eigen::VectorXd::Constant(1, 0.1);
  Fit fit;
  fit.causes = {{&effect("sensor_gain"), 0, size},
                {&effect("ground_spring"), 0, Eigen::Vector3d(std::log(1e5), 0.02, 0.04)}};
  EXPECT_TRUE(is_there_already(plate, fit, {&effect("sensor_gain"), 0, size}));
  EXPECT_FALSE(is_there_already(plate, fit, {&effect("sensor_gain"), 1, size}));
  EXPECT_FALSE(is_there_already(plate, fit, {&effect("actuator_gain"), 0, size}));
  EXPECT_FALSE(
      is_there_already(plate, fit, {&effect("point_mass"), 0, Eigen::Vector3d(0.01, 0.02, 0.04)}));
}

// A spring that is spread over a disc is no spring and a softer patch in the same place.
TEST(Search, PutsNoPatchWhereSomethingIsAlready) {
  const auto& plate = small_plate();
  const Supposed spring{&effect("ground_spring"), 0, Eigen::Vector3d(std::log(1e5), 0.02, 0.04)};
  const Eigen::Vector4d soft(-0.05, 0.02, 0.045, std::log(0.03));
  const auto observed = noisy(plate, {spring, {&effect("local_stiffness"), 0, soft}}, 8);
  const auto found = found_in(plate, observed, {"ground_spring", "local_stiffness"});
  EXPECT_GT(found.fits.front().excess(observed.number_count()), 5.0);
  for (const auto& fit : found.fits) {
    EXPECT_FALSE(has(fit, "ground_spring") && has(fit, "local_stiffness") &&
                 (*place_of(fit.causes[0], plate) - *place_of(fit.causes[1], plate)).norm() < 0.03);
  }
}

}  // namespace
}  // namespace chladni::diagnosis
