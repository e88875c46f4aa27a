// Without memory: work is done or refused, and the process lives.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "base/quantity.h"
#include "host/folder.h"
#include "host/parallel.h"
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

TEST(Folder, WithoutMemoryThrows) {
  const std::filesystem::path folder = CHLADNI_SOURCE_DIR "/tests/host";
  const auto all = entries_of(folder);
  EXPECT_EQ(std::ranges::count(all, folder / "no_memory_test.cpp"), 1);
  EXPECT_EQ(std::ranges::count(all, folder / ".."), 0);
  EXPECT_TRUE(entries_of(folder / "none").empty());
  const long failures =
      without_memory(1000, 1, [&] { EXPECT_EQ(entries_of(folder).size(), all.size()); });
  EXPECT_GT(failures, static_cast<long>(all.size()));
}

// What was begun is removed where memory has ended.
TEST(Folder, IsRemovedWithoutMemory) {
  namespace fs = std::filesystem;
  const auto folder = fs::temp_directory_path() / ("chladni_removed_" + std::to_string(getpid()));
  fs::create_directories(folder / "in" / "inner");
  for (int i = 0; i < 300; ++i) {
    std::ofstream(folder / "in" / ("a_name_of_some_length_" + std::to_string(i))) << i;
  }
  std::ofstream(folder / "in" / "inner" / "file") << 1;
  std::ofstream(folder / "kept") << 1;
  fs::create_symlink(folder / "kept", folder / "in" / "link");
  fs::create_directory_symlink(folder, folder / "in" / "up");
  const auto in = folder / "in";
  const auto kept = folder / "kept";
  EXPECT_EQ(without_memory(1, 1, [&] { remove_whole(in); }), 0);
  EXPECT_FALSE(fs::exists(in));
  EXPECT_TRUE(fs::exists(kept));
  remove_whole(kept);
  EXPECT_FALSE(fs::exists(kept));
  remove_whole(folder / "none");
  remove_whole(folder);
  EXPECT_FALSE(fs::exists(folder));
}

}  // namespace
}  // namespace chladni
