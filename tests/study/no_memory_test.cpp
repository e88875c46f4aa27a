// Without memory: a study is read or refused as too large, and its numbers are not called wrong.
#include <gtest/gtest.h>

#include "study/toml/toml_tree.h"
#include "tests/failing_new.h"

namespace chladni::study {
namespace {

TEST(Toml, WithoutMemoryIsRefusedAsThat) {
  const std::string text =
      "title = \"a stage with a title that is longer than the room within a string\"\n"
      "[experiment]\nnoise_ratio = 0.002\nband = [\"200 Hz\", 1.6e4, -0.5, 1_000.25, 0x10, inf]\n";
  const auto failures = without_memory(
      10000, 1, [&] { EXPECT_EQ(parse_toml(text, "study.toml").members.size(), 2U); });
  EXPECT_GT(failures, 10);
}

}  // namespace
}  // namespace chladni::study
