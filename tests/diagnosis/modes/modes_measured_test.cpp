#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>

#include "base/error.h"
#include "diagnosis/diagnosed_modes.h"
#include "diagnosis/loaded_plate.h"
#include "rotation/turn.h"

namespace chladni::diagnosis {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

class BadModes : public testing::Test {
 protected:
  static void expect_refused(const std::function<void(MeasuredModes&)>& spoil,
                             const std::string& word) {
    auto measured = measured_of(modes_of(loaded()), 0.01);
    spoil(measured);
    try {
      (void)diagnosed(small_plate(), measured);
      ADD_FAILURE() << "taken: " << word;
    } catch (const InvalidInput& refused) {
      EXPECT_NE(std::string(refused.what()).find(word), std::string::npos) << refused.what();
    }
  }
};

TEST_F(BadModes, AreRefused) {
  expect_refused([](auto& modes) { modes = MeasuredModes{}; }, "there is none");
  expect_refused([](auto& modes) { std::swap(modes.frequency_hz(1), modes.frequency_hz(2)); },
                 "ascending");
  expect_refused([](auto& modes) { modes.frequency_hz(0) = 0.0; }, "above 0");
  expect_refused([](auto& modes) { modes.frequency_hz(3) = kNone; }, "mode 4");
  expect_refused([](auto& modes) { modes.frequency_std(1) = -0.1; }, "-0.1");
  expect_refused([](auto& modes) { modes.frequency_std(1) = kNone; }, "nan");
  expect_refused([](auto& modes) { modes.damping_std(2) = HUGE_VAL; }, "inf");
  expect_refused([](auto& modes) { modes.damping_ratio.conservativeResize(5); }, "number");
  expect_refused([](auto& modes) { modes.output_shapes.conservativeResize(3, 9); }, "3x9");
  expect_refused([](auto& modes) { modes.output_std.conservativeResize(4, 8); }, "4x8");
  expect_refused([](auto& modes) { modes.output_std(2, 1) = -1.0; }, "-1");
  expect_refused([](auto& modes) { modes.input_std.resize(1, 9); }, "1x9");
  expect_refused(
      [](auto& modes) {
        for (auto& name : modes.outputs) name += "x";
      },
      "in common");
}

// A fit of two modes at one sensor and one actuator.
identification::ModalFit two_modes() {
  identification::ModalFit fit;
  fit.model.frequency_hz = Eigen::Vector2d(100.0, 200.0);
  fit.model.damping_ratio = Eigen::Vector2d(0.01, 1e-8);
  fit.model.output_shapes = Eigen::MatrixXd::Ones(1, 2);
  fit.model.input_shapes = Eigen::MatrixXd::Ones(2, 1);
  fit.frequency_std_hz = Eigen::Vector2d(0.1, 0.1);
  fit.damping_std = Eigen::Vector2d(1e-4, 1e-9);
  fit.output_std = Eigen::MatrixXd::Constant(1, 2, 0.01);
  fit.input_std = Eigen::MatrixXd::Constant(2, 1, 0.01);
  return fit;
}

// The damping of a mode at its bound has an infinite deviation: the data do not show it.
TEST(MeasuredModes, HaveNoDampingWhereItsDeviationIsInfinite) {
  auto fit = two_modes();
  fit.damping_std(1) = HUGE_VAL;
  const auto modes = measured_modes(fit, {"s"}, {"a"}, 50.0, 300.0);
  ASSERT_EQ(modes.count(), 2);
  EXPECT_NO_THROW(check(modes));
  EXPECT_EQ(modes.damping_ratio(0), 0.01);
  EXPECT_TRUE(std::isnan(modes.damping_ratio(1)));
}

TEST(MeasuredModes, AreNotThereWhereTheirFrequencyIsNotKnown) {
  auto fit = two_modes();
  fit.frequency_std_hz(0) = HUGE_VAL;
  EXPECT_EQ(measured_modes(fit, {"s"}, {"a"}, 50.0, 300.0).frequency_hz,
            Eigen::VectorXd::Constant(1, 200.0));
}

// The infinite deviation made every likelihood infinite, and the search ended the program.
TEST(MeasuredModes, AreDiagnosedWithoutTheDampingOfOne) {
  EVERY_EIGHTH_LANDING();
  auto modes = measured_of(modes_of(loaded()), 0.01);
  modes.damping_ratio(2) = kNone;
  modes.damping_std(2) = 0.0;
  const auto told = diagnosed(small_plate(), modes);
  ASSERT_FALSE(told.best.causes.empty());
  EXPECT_EQ(told.best.causes.front().effect, "point_mass");
}

}  // namespace
}  // namespace chladni::diagnosis
