#include "host/memory.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>

#include "tests/refusal.h"

namespace chladni {
namespace {

TEST(AvailableMemory, IsSomethingAndNotMoreThanThereIs) {
  const auto all = static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) *
                   static_cast<std::size_t>(sysconf(_SC_PAGE_SIZE));
  EXPECT_GT(available_memory(), std::size_t{1} << 20U);
  EXPECT_LE(available_memory(), all);
}

TEST(BytesOfGigabytes, AreThoseOfANumber) {
  EXPECT_EQ(bytes_of_gigabytes(0.0), 0U);
  EXPECT_EQ(bytes_of_gigabytes(1.5), 1'500'000'000U);
  for (const double many : {1e30, HUGE_VAL}) {
    EXPECT_GE(bytes_of_gigabytes(many), std::size_t{1} << 62U) << many;
  }
  for (const double wrong : {-1.0, std::nan("")}) {
    EXPECT_NE(refusal_of([&] { return bytes_of_gigabytes(wrong); }).find("expected 0 or more"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace chladni
