// Without memory: work is done or refused, and the process lives.
#include <gtest/gtest.h>

#include <atomic>
#include <sstream>
#include <vector>

#include "base/parallel.h"
#include "base/quantity.h"
#include "tests/failing_new.h"

namespace chladni {
namespace {

TEST(Parallel, AThreadWithoutMemoryIsDoneWithout) {
  set_thread_count(4);
  const long failures = without_memory(100, 1, [] {
    std::atomic<int> sum{0};
    parallel_ranges(100, [&](std::size_t begin, std::size_t end) {
      for (auto i = begin; i < end; ++i) sum += static_cast<int>(i);
    });
    EXPECT_EQ(sum, 4950);
  });
  EXPECT_GT(failures, 0);
}

TEST(Quantity, WithoutMemoryIsRefusedAsThat) {
  EXPECT_EQ(quantity("20 mm", "m"), 0.02);  // the database of units is there now
  const long failures = without_memory(100, 1, [] { EXPECT_EQ(quantity("20 mm", "m"), 0.02); });
  EXPECT_GT(failures, 0);
}

}  // namespace
}  // namespace chladni
