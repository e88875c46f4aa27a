#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <utility>

#include "base/error.h"
#include "diagnosis/diagnosed_modes.h"
#include "diagnosis/loaded_plate.h"

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

}  // namespace
}  // namespace chladni::diagnosis
