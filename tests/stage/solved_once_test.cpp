// One solution serves a study and its diagnosis.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "stage/diagnosis_structure.h"
#include "stage/solution.h"

namespace chladni::stage {
namespace {

constexpr int kMore = 16;

study::Study plate(const std::string& modes, const std::string& width = "300 mm") {
  return study::parse_study(R"(
[geometry]
plate = { length = "400 mm", width = ")" +
                                width + R"(", thickness = "12 mm" }
[material]
youngs_modulus = "70 GPa"
poissons_ratio = 0.33
density = "2700 kg/m^3"
[mesh]
edge_length = "50 mm"
order = 2
[modes]
)" + modes,
                            "plate.toml");
}

struct BothWays {
  Solution alone, more_alone;
  TwoSolutions once;
};

BothWays both_ways(const study::Study& study) {
  Work work;
  auto larger = study;
  larger.modes.count = std::max(larger.modes.count, kMore);
  larger.modes.up_to_hz = 0.0;
  return {solved(study, work), solved(larger, work), solved_with_more(study, kMore, work)};
}

void expect_the_same(const Solution& one, const Solution& other) {
  ASSERT_EQ(one.modes.mode_count(), other.modes.mode_count());
  EXPECT_EQ(one.modes.rigid_count, other.modes.rigid_count);
  const auto rigid = one.modes.rigid_count;
  const auto flexible = one.modes.mode_count() - rigid;
  const Eigen::ArrayXd ratio = one.modes.frequency_hz.tail(flexible).array() /
                               other.modes.frequency_hz.tail(flexible).array();
  EXPECT_LT((ratio - 1.0).abs().maxCoeff(), 1e-10);
  const double size = other.modes.shapes.cwiseAbs().maxCoeff();
  EXPECT_LT((one.modes.shapes - other.modes.shapes).cwiseAbs().maxCoeff(), 1e-6 * size);
  EXPECT_LT((one.frequency_error - other.frequency_error).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_EQ(one.summary.residual.size(), one.modes.mode_count());
  EXPECT_EQ(one.extra_shapes.cols(), one.modes.mode_count());
}

TEST(SolvedOnce, GivesTheStudysModesAndThoseOfALargerCount) {
  const auto found = both_ways(plate("count = 9\n"));
  expect_the_same(found.once.own, found.alone);
  EXPECT_EQ(found.once.own.introduction.warnings, found.alone.introduction.warnings);
  EXPECT_GE(found.once.with_more.modes.mode_count(), 6 + kMore);
  expect_the_same(found.once.with_more, found.more_alone);
}

TEST(SolvedOnce, GivesTheModesUpToAFrequency) {
  const auto found = both_ways(plate("up_to = \"900 Hz\"\n"));
  ASSERT_GT(found.alone.modes.mode_count(), 8);
  expect_the_same(found.once.own, found.alone);
  expect_the_same(found.once.with_more, found.more_alone);
}

TEST(SolvedOnce, GoesBeyondTheLargerCountForAHighFrequency) {
  const auto found = both_ways(plate("up_to = \"6 kHz\"\n"));
  ASSERT_GT(found.alone.modes.mode_count(), found.more_alone.modes.mode_count());
  expect_the_same(found.once.own, found.alone);
  expect_the_same(found.once.with_more, found.more_alone);
}

TEST(SolvedOnce, CutsNoRepeatedMode) {
  const auto found = both_ways(plate("count = 4\n", "400 mm"));
  ASSERT_EQ(found.alone.modes.mode_count(), 6 + 5);  // flexible modes 4 and 5 are one
  expect_the_same(found.once.own, found.alone);
}

// The width splits flexible modes 4 and 5 of a square plate, by less than a mesh does.
TEST(SolvedOnce, CutsNoRepeatedModeAtAFrequency) {
  Work work;
  const auto all = solved(plate("count = 6\n", "399.98 mm"), work).modes.frequency_hz;
  ASSERT_GT(all(10), all(9) * (1.0 + 1e-7));
  ASSERT_LT(all(10), all(9) * (1.0 + 1e-3));
  const auto found = both_ways(
      plate(fmt::format("up_to = \"{:.12g} Hz\"\n", 0.5 * (all(9) + all(10))), "399.98 mm"));
  ASSERT_EQ(found.alone.modes.mode_count(), 6 + 5);
  EXPECT_EQ(found.alone.summary.clusters.back().size, 2);
  expect_the_same(found.once.own, found.alone);
}

}  // namespace
}  // namespace chladni::stage
