// What was told, as a hypothesis again.
#include "diagnosis/hypothesis.h"

#include <gtest/gtest.h>

#include <numbers>

#include "base/error.h"
#include "diagnosis/compare.h"
#include "diagnosis/small_plate.h"
#include "modal/frf.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd lines_hz() { return some_lines() / (2.0 * std::numbers::pi); }

// As a verdict tells it.
Cause told(const Effect& effect, Index option, const VectorXd& x) {
  Cause cause;
  cause.effect = effect.name;
  cause.channels = effect.channels(small_plate(), option);
  cause.option = choice_of(effect, option).text;
  Index i = 0;
  for (const auto& parameter : effect.parameters(small_plate())) {
    cause.parameters.push_back(
        {std::string(parameter.name), std::string(parameter.unit), parameter.value(x(i++)), 0.0});
  }
  return cause;
}

VectorXd some_size(const Effect& effect) {
  const auto parameters = effect.parameters(small_plate());
  VectorXd x(static_cast<Index>(parameters.size()));
  for (Index i = 0; i < x.size(); ++i) {
    const auto& one = parameters[static_cast<std::size_t>(i)];
    x(i) = one.is_place() ? 0.05 : one.centre + 0.3 * one.width;
  }
  return x;
}

double apart(const std::vector<Eigen::MatrixXcd>& a, const std::vector<Eigen::MatrixXcd>& b) {
  double difference = 0.0;
  double size = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    difference += (a[k] - b[k]).squaredNorm();
    size += b[k].squaredNorm();
  }
  return std::sqrt(difference / size);
}

TEST(Hypothesis, OfWhatWasToldIsWhatWasSupposed) {
  for (const auto* effect : effects()) {
    const Index options = effect->options(small_plate());
    for (Index option = 0; option < options; ++option) {
      const auto x = some_size(*effect);
      const auto again = supposed_of(told(*effect, option, x), small_plate());
      ASSERT_EQ(again.size(), 1U) << effect->name;
      EXPECT_EQ(again.front().effect, effect);
      EXPECT_EQ(again.front().option, option) << effect->name;
      EXPECT_TRUE(again.front().x.isApprox(x, 1e-12) || x.size() == 0) << effect->name;
    }
  }
}

// Record i shows the sensor that the cause says, whatever the cycles.
TEST(Hypothesis, PermutesLabelsByExchanges) {
  const auto& names = small_plate().outputs.names;
  const std::vector<std::vector<Index>> orders{{1, 2, 0}, {2, 0, 1}, {1, 0, 2}};
  for (const auto& order : orders) {
    Cause mixed;
    mixed.effect = "permuted_sensors";
    for (std::size_t i = 0; i < order.size(); ++i) {
      mixed.channels.push_back(names.at(i));
      mixed.truly.push_back(names.at(static_cast<std::size_t>(order[i])));
    }
    auto state = state_of(small_plate());
    const auto before = state.output_of;
    for (const auto& one : supposed_of(mixed, small_plate())) {
      change_of(one, small_plate())(state);
    }
    for (std::size_t i = 0; i < before.size(); ++i) {
      EXPECT_EQ(state.output_of[i], i < order.size() ? order[i] : before[i]) << i;
    }
  }
}

TEST(Hypothesis, WithoutCausesIsTheSimulation) {
  const auto simulated = modal::frf(reduced_model(small_plate()), lines_hz()).value;
  EXPECT_LT(apart(predicted(small_plate(), {}, lines_hz()), simulated), 1e-10);
}

TEST(Hypothesis, AppliesItsCausesOneAfterTheOther) {
  const auto& mass = effect("point_mass");
  const auto& frame = effect("frame");
  const auto a = some_size(mass);
  const auto b = some_size(frame);
  State state = state_of(small_plate());
  mass.apply(state, small_plate(), 0, a);
  frame.apply(state, small_plate(), 0, b);
  const Eigen::MatrixXcd expected = responses(state, some_lines());
  const auto found = predicted(small_plate(), {told(mass, 0, a), told(frame, 0, b)}, lines_hz());
  for (Index k = 0; k < expected.rows(); ++k) {
    const Eigen::MatrixXcd line = expected.row(k).transpose().reshaped(small_plate().output_count(),
                                                                       small_plate().input_count());
    EXPECT_LT((found[static_cast<std::size_t>(k)] - line).norm(), 1e-12 * line.norm());
  }
}

// A constant keeps the damping ratios, which the effect of the same name does not, and directions
// of the stiffness are no effects of the catalogue.
TEST(Hypothesis, HasConstantsAsTheFitsHaveThem) {
  const auto calibrated = [](const std::string& effect, double by, bool determined = true) {
    return CalibratedNumber{"material." + effect, "1", effect, 2.0, 2.0 * by, 0.0, 0.1, determined};
  };
  const double by = 1.21;  // all frequencies grow by 10 %, their ratios stay
  auto stiffer = reduced_model(small_plate());
  stiffer.frequency_hz *= std::sqrt(by);
  stiffer.residual /= by;
  const auto expected = modal::frf(stiffer, lines_hz()).value;
  const auto found = predicted(small_plate(), {calibrated("youngs_modulus", by)}, {}, lines_hz());
  EXPECT_LT(apart(found, expected), 1e-10);
  const auto nothing = predicted(small_plate(), {}, lines_hz());
  for (const auto* name : {"stiffness_along_u", "stiffness_along_v", "shear_stiffness", "thickness",
                           "density", "modal_damping"}) {
    EXPECT_GT(apart(predicted(small_plate(), {calibrated(name, by)}, {}, lines_hz()), nothing),
              1e-3)
        << name;
    EXPECT_EQ(
        apart(predicted(small_plate(), {calibrated(name, by, false)}, {}, lines_hz()), nothing),
        0.0);
  }
  EXPECT_THROW((void)predicted(small_plate(), {calibrated("gremlin", by)}, {}, lines_hz()),
               InvalidInput);
}

// A unit of three sensors, told of a structure of which three are seen, on one of four.
TEST(Hypothesis, OfSeveralChannelsThatAreNotAllIsOneOfEach) {
  const auto& unit = effect("sensor_unit");
  auto cause = told(unit, 0, {});
  cause.channels = {"s1", "s3"};
  const auto each = supposed_of(cause, small_plate());
  ASSERT_EQ(each.size(), 2U);
  EXPECT_EQ(unit.channels(small_plate(), each[1].option), std::vector<std::string>{"s3"});
  EXPECT_EQ(choice_of(unit, each[1].option).text, cause.option);
}

TEST(Hypothesis, RefusesWhatWasNotTold) {
  Cause cause;
  cause.effect = "point_mass";
  EXPECT_THROW(static_cast<void>(supposed_of(cause, small_plate())), InvalidInput);
  cause.effect = "gremlin";
  EXPECT_THROW(static_cast<void>(supposed_of(cause, small_plate())), InvalidInput);
  cause = told(effect("sensor_sign"), 0, {});
  cause.channels = {"nowhere"};
  EXPECT_THROW(static_cast<void>(supposed_of(cause, small_plate())), InvalidInput);
}

}  // namespace
}  // namespace chladni::diagnosis
