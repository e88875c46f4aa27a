#include "diagnosis/search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string_view>

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
  std::mt19937_64 random(seed);
  std::normal_distribution<double> part(0.0, std::sqrt(0.5));
  for (Index i = 0; i < observed.value.size(); ++i) {
    const double real = part(random);
    observed.value.data()[i] += sigma.data()[i] * std::complex<double>(real, part(random));
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

}  // namespace
}  // namespace chladni::diagnosis
