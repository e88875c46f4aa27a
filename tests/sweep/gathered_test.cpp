// Numbers of results, and the front of those that no other beats.
#include "sweep/gathered.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "base/draw.h"

namespace chladni::sweep {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd random_values(Index n, Index k, unsigned seed) {
  Draw draw(seed);
  MatrixXd values(n, k);
  for (double& value : values.reshaped()) value = std::floor(6.0 * draw.uniform());  // with ties
  return values;
}

bool is_as_good(const MatrixXd& values, Index a, Index b) {
  return (values.row(a).array() >= values.row(b).array()).all();
}

// Every row is as good as itself alone or beaten by one of the front, and none of the front is
// beaten.
TEST(ParetoFront, BeatsEveryOtherAndIsNotBeaten) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto values = random_values(60, 1 + seed % 4, seed);
    const auto front = pareto_front(values);
    for (Index i = 0; i < values.rows(); ++i) {
      bool beaten = false;
      for (Index other = 0; other < values.rows(); ++other) {
        const bool beats = is_as_good(values, other, i) && !is_as_good(values, i, other);
        beaten = beaten || (beats && front[static_cast<std::size_t>(other)]);
        EXPECT_FALSE(beats && front[static_cast<std::size_t>(i)]);
      }
      EXPECT_NE(beaten, front[static_cast<std::size_t>(i)]) << seed << " " << i;
    }
  }
}

TEST(ParetoFront, DoesNotMindTheOrderOrTheScale) {
  const auto values = random_values(40, 3, 7);
  const auto front = pareto_front(values);
  MatrixXd other = values.colwise().reverse();
  other.col(0) = other.col(0).array().exp().matrix();
  other.col(2) = 1e6 * other.col(2);
  const auto again = pareto_front(other);
  for (std::size_t i = 0; i < front.size(); ++i) EXPECT_EQ(front[i], again[front.size() - 1 - i]);
}

// A frequency that is higher by a rounding error does not make up for more mass.
TEST(ParetoFront, TakesARoundingErrorForNoGain) {
  Eigen::MatrixXd values(2, 2);
  values << 634.7158623572111, -1.964, 634.7158623576873, -1.994;
  EXPECT_EQ(pareto_front(values), std::vector<bool>({true, false}));
}

TEST(ParetoFront, LeavesOutWhatHasNoValue) {
  MatrixXd values(3, 2);
  values << 1.0, 1.0, std::numeric_limits<double>::quiet_NaN(), 9.0, 0.0, 2.0;
  EXPECT_EQ(pareto_front(values), (std::vector<bool>{true, false, true}));
}

TEST(NumberAt, FollowsKeysAndPlaces) {
  const auto json = io::parse_json(
      R"({"modes": [{"frequency_hz": 1.5}, {"frequency_hz": 7}], "name": "x", "n": null})");
  EXPECT_EQ(number_at(json, "modes.0.frequency_hz"), 1.5);
  EXPECT_EQ(number_at(json, "modes.1.frequency_hz"), 7.0);
  for (const char* nowhere : {"modes.2.frequency_hz", "modes.x", "mode", "name", "n", "modes"}) {
    EXPECT_TRUE(std::isnan(number_at(json, nowhere))) << nowhere;
  }
}

}  // namespace
}  // namespace chladni::sweep
