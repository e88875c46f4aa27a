#include "io/measured/frf_suspicions.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "base/draw.h"
#include "tests/modal/chain.h"

namespace chladni::io {
namespace {

using modal::FrfKind;

// A free chain of six masses, sensors at masses 1, 4 and 6, actuators at 1 and 4.
modal::FrfSet measured(FrfKind kind, double damping, Eigen::Index lines) {
  const auto model = modal::reduced(modal::chain(6, false), 6, {0, 3, 5}, {0, 3}, damping);
  const auto frf = modal::frf(model, Eigen::VectorXd::LinSpaced(lines, 20.0, 3600.0), kind);
  modal::FrfSet set;
  const long long nodes[] = {1, 4, 6};
  for (const auto node : nodes) {
    auto& output = set.outputs.emplace_back();
    output.name = "y" + std::to_string(node);
    output.kind = kind;
    output.node = node;
    output.direction = Eigen::Vector3d::UnitZ();
    if (node == 6) continue;
    set.inputs.push_back(output);
    set.inputs.back().name = "u" + std::to_string(node);
  }
  set.frequency_hz = frf.frequency_hz;
  set.value = frf.value;
  return set;
}

int times(const std::vector<std::string>& said, const std::string& word) {
  int count = 0;
  for (const auto& one : said) count += one.find(word) != std::string::npos ? 1 : 0;
  return count;
}

constexpr FrfKind kKinds[] = {FrfKind::receptance, FrfKind::mobility, FrfKind::accelerance};

TEST(Suspicions, ThereAreNoneOfAStructure) {
  for (const auto kind : kKinds) {
    for (const double damping : {1e-3, 0.01, 0.1}) {
      const auto said = suspicions(measured(kind, damping, 2000));
      EXPECT_TRUE(said.empty()) << testing::PrintToString(said);
    }
  }
}

TEST(Suspicions, AValueAMillionTimesItsNeighboursIsNamed) {
  for (const auto kind : kKinds) {
    for (const Eigen::Index line : {Eigen::Index{0}, Eigen::Index{1}, Eigen::Index{1200}}) {
      auto set = measured(kind, 0.01, 2000);
      auto& value = set.value[static_cast<std::size_t>(line)](2, 1);
      value *= 1e5;
      EXPECT_EQ(times(suspicions(set), "a million times"), 0);
      value *= 1e3;
      const auto said = suspicions(set);
      EXPECT_EQ(times(said,
                      "y6/u4: more than a million times the neighbours on 1 line, the first "
                      "is line " +
                          std::to_string(line + 1) + " ("),
                1)
          << testing::PrintToString(said);
      EXPECT_EQ(times(said, "a million times"), 1);
    }
  }
}

// A free body's receptance grows as 1/f² towards 0 Hz, whatever the first lines are.
TEST(Suspicions, ARigidBodyNearZeroIsNoSpike) {
  modal::FrfSet set;
  set.outputs.emplace_back().name = "y1";
  set.inputs.emplace_back().name = "u1";
  set.frequency_hz.resize(6);
  set.frequency_hz << 0.0, 1e-4, 1.0, 2.0, 3.0, 4.0;
  for (Eigen::Index k = 0; k < 6; ++k) {
    const double f = set.frequency_hz(k);
    set.value.emplace_back(Eigen::MatrixXcd::Constant(1, 1, k == 0 ? 1e30 : 1.0 / (f * f)));
  }
  EXPECT_EQ(times(suspicions(set), "a million times"), 0);
}

TEST(Suspicions, NorOfALineSpacingFarAboveTheBandwidth) {
  for (const auto kind : kKinds) {
    const auto said = suspicions(measured(kind, 1e-4, 300));
    EXPECT_EQ(times(said, "conjugated") + times(said, "sign"), 0) << testing::PrintToString(said);
  }
}

TEST(Suspicions, ConjugatedResponsesAreNamedWhateverTheChannels) {
  for (const auto kind : kKinds) {
    auto set = measured(kind, 0.01, 2000);
    for (auto& line : set.value) line.row(1) = line.row(1).conjugate().eval();
    const auto said = suspicions(set);
    EXPECT_EQ(times(said, "y4/u1, y4/u4 look conjugated"), 1);
    EXPECT_EQ(times(said, "sign"), 0) << testing::PrintToString(said);
  }
}

TEST(Suspicions, ATurnedSignShowsWhereTheChannelsAreCollocated) {
  for (const auto kind : kKinds) {
    for (const bool conjugated : {false, true}) {
      auto set = measured(kind, 0.01, 2000);
      for (auto& line : set.value) {
        line.row(0) *= -1.0;
        if (conjugated) line = line.conjugate().eval();
      }
      const auto said = suspicions(set);
      EXPECT_EQ(times(said, "sign"), 1);
      EXPECT_EQ(times(said, "y1/u1 looks as if its sign were turned"), 1);
      EXPECT_EQ(times(said, "y1/u1, y1/u4, y4/u1, y4/u4, y6/u1, y6/u4 look conjugated"),
                conjugated ? 1 : 0);
    }
  }
}

TEST(Suspicions, AVarianceAboveTheResponseIsTold) {
  auto set = measured(FrfKind::receptance, 0.01, 2000);
  for (const auto& line : set.value) set.variance.emplace_back(0.01 * line.cwiseAbs2());
  EXPECT_TRUE(suspicions(set).empty());
  for (auto& line : set.variance) line(1, 0) = 1e99;
  EXPECT_EQ(times(suspicions(set), "y4/u1: its variance is more than its square on all lines"), 1);
  set.variance[7](1, 0) = 1e-60;
  EXPECT_TRUE(suspicions(set).empty()) << "one line says something";
}

TEST(Suspicions, OppositeDirectionsExpectTheOtherSign) {
  auto set = measured(FrfKind::receptance, 0.01, 2000);
  set.outputs[0].direction *= -1.0;
  EXPECT_EQ(times(suspicions(set), "y1/u1 looks as if its sign"), 1);
  for (auto& line : set.value) line.row(0) *= -1.0;
  EXPECT_TRUE(suspicions(set).empty());
  set.outputs[0].node.reset();
  EXPECT_EQ(times(suspicions(set, {{"y1", "u1"}}), "y1/u1 looks as if its sign"), 1);
}

TEST(Suspicions, NoiseAloneHasNoDirection) {
  auto set = measured(FrfKind::receptance, 0.01, 2000);
  Draw draw(5);
  for (auto& line : set.value) {
    for (auto& value : line.reshaped()) {
      const double real = draw.normal();
      value = {real, draw.normal()};
    }
  }
  EXPECT_TRUE(suspicions(set).empty());
}

TEST(Suspicions, GapsAndCopiesAreNamedWithTheirPlaces) {
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  auto set = measured(FrfKind::receptance, 0.01, 100);
  for (auto& line : set.value) line(2, 1) = {nothing, nothing};
  for (auto& line : set.value) line(1, 0) = 0.0;
  set.value[7](0, 0) = {nothing, 0.0};
  set.value[9](0, 1) = 0.0;
  set.value[12](0, 1) = 0.0;
  for (auto& line : set.value) line(2, 0) = line(1, 1);
  const auto said = suspicions(set);
  EXPECT_EQ(times(said, "y6/u4: not measured"), 1);
  EXPECT_EQ(times(said, "y4/u1: zero on all lines"), 1);
  EXPECT_EQ(times(said, "y1/u1: no value on 1 line, the first is line 8 ("), 1);
  EXPECT_EQ(times(said, "y1/u4: exactly zero on 2 lines, the first is line 10 ("), 1);
  EXPECT_EQ(times(said, "y6/u1 is the same as y4/u4"), 1);
}

TEST(Suspicions, AGapInAllResponsesIsSaidOnce) {
  auto set = measured(FrfKind::receptance, 0.01, 100);
  set.value[3].setConstant(std::numeric_limits<double>::quiet_NaN());
  const auto said = suspicions(set);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].find("all responses: no value on 1 line, the first is line 4 ("), 0U);
}

}  // namespace
}  // namespace chladni::io
