#include "base/upper_median.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <random>
#include <vector>

namespace chladni {
namespace {

TEST(UpperMedian, HasAsManyBelowItAsAbove) {
  std::mt19937 random(5);
  for (int size = 1; size < 40; ++size) {
    std::vector<double> values;
    for (int i = 0; i < size; ++i) values.push_back(static_cast<double>(random() % 20));
    auto sorted = values;
    std::sort(sorted.begin(), sorted.end());
    Eigen::VectorXd vector = Eigen::Map<const Eigen::VectorXd>(values.data(), size);
    EXPECT_EQ(upper_median(values), sorted[values.size() / 2]);
    EXPECT_EQ(upper_median(vector), sorted[values.size() / 2]);
    std::sort(values.begin(), values.end());
    EXPECT_EQ(values, sorted);  // no value was lost
  }
}

}  // namespace
}  // namespace chladni
