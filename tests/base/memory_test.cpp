#include "base/memory.h"

#include <gtest/gtest.h>
#include <unistd.h>

namespace chladni {
namespace {

TEST(AvailableMemory, IsSomethingAndNotMoreThanThereIs) {
  const auto all = static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) *
                   static_cast<std::size_t>(sysconf(_SC_PAGE_SIZE));
  EXPECT_GT(available_memory(), std::size_t{1} << 20U);
  EXPECT_LE(available_memory(), all);
}

}  // namespace
}  // namespace chladni
