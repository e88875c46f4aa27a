#include "rotation/drawn_sample.h"

#include <gtest/gtest.h>

#include <set>

#include "base/error.h"

namespace chladni::rotation {
namespace {

const TreeState kTree{"f231a40c5d1e0000000000000000000000000000", 320, false};

TEST(DrawnSample, FourInARowHaveEveryKind) {
  for (const unsigned long first : {1UL, 320UL, 4711UL}) {
    std::set<std::size_t> kinds;
    std::size_t times = 0;
    for (unsigned long n = first; n < first + 4; ++n) {
      auto tree = kTree;
      tree.commit[0] = "0123456789abcdef"[n * 7 % 16];  // hashes are as they come
      tree.landings = n;
      const auto sample = drawn_sample("", tree);
      for (std::size_t kind = 0; kind < 51; ++kind) {
        if (!sample.has(kind)) continue;
        kinds.insert(kind);
        ++times;
      }
    }
    EXPECT_EQ(kinds.size(), 51U) << first;
    EXPECT_EQ(times, 51U) << first;  // each once
  }
}

TEST(DrawnSample, EightInARowHaveEveryDearKind) {
  for (const unsigned long first : {1UL, 320UL, 4711UL}) {
    std::set<std::size_t> kinds;
    for (unsigned long n = first; n < first + 8; ++n) {
      auto tree = kTree;
      tree.landings = n;
      const auto sample = drawn_sample("", tree);
      for (std::size_t kind = 0; kind < 24; ++kind) {
        if (!sample.has_half(kind)) continue;
        EXPECT_TRUE(sample.has(kind));
        EXPECT_EQ(sample.eighth(), kind % 8);
        EXPECT_TRUE(kinds.insert(kind).second) << kind;  // each once
      }
    }
    EXPECT_EQ(kinds.size(), 24U) << first;
  }
  EXPECT_TRUE(drawn_sample("7", {}).has_half(7));
  EXPECT_EQ(drawn_sample("7", {}).eighth(), 7U);
  EXPECT_FALSE(drawn_sample("7", {}).has_half(3));
  EXPECT_TRUE(drawn_sample("all", kTree).has_half(3));
}

TEST(DrawnSample, IsRepeatedByItsNumber) {
  const auto drawn = drawn_sample("", kTree);
  const auto again = drawn_sample(std::to_string(drawn.number), {});
  EXPECT_EQ(again.seed(), drawn.seed());
  for (std::size_t kind = 0; kind < 8; ++kind) EXPECT_EQ(again.has(kind), drawn.has(kind));
  EXPECT_EQ(drawn.seed(), 1U);  // whatever the commit
  EXPECT_EQ(drawn_sample("43", {}).seed(), 11U);
  EXPECT_TRUE(drawn_sample("43", {}).has(3));
}

TEST(DrawnSample, SaysWhereItComesFrom) {
  EXPECT_NE(drawn_sample("", kTree).from.find("f231a40c"), std::string::npos);
  auto shallow = kTree;
  shallow.is_shallow = true;
  EXPECT_NE(drawn_sample("", shallow).from.find("shallow"), std::string::npos);
  std::set<unsigned> quarters;  // though the count stays
  for (const char digit : {'0', '1', '2', '3', '4', '5', '6', '7', '8', '9', 'a', 'b'}) {
    shallow.commit[3] = digit;
    quarters.insert(drawn_sample("", shallow).number % 4);
  }
  EXPECT_EQ(quarters.size(), 4U);
  EXPECT_EQ(drawn_sample("", {}).from, "no git here");
  EXPECT_TRUE(drawn_sample("all", kTree).has(3) && drawn_sample("all", kTree).has(4));
  EXPECT_THROW((void)drawn_sample("some", kTree), InvalidInput);
}

TEST(DrawnSample, HearsGit) {
  EXPECT_EQ(tree_state("/nowhere/at/all").commit, "");
  const auto here = tree_state(CHLADNI_SOURCE_DIR);
  if (here.commit.empty()) GTEST_SKIP() << "no git here";
  EXPECT_EQ(here.commit.size(), 40U);
  EXPECT_GT(here.landings, 0U);
}

}  // namespace
}  // namespace chladni::rotation
