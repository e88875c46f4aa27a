#include "host/limits/control_group.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace chladni {
namespace {

namespace fs = std::filesystem;

// A tree of groups as the kernel shows it: /slice/unit/leaf, this process in the leaf.
class ControlGroup : public ::testing::Test {
 protected:
  ControlGroup() {
    fs::create_directories(files_.root / "slice/unit/leaf");
    write(files_.membership, "12:cpuset:/elsewhere\n0::/slice/unit/leaf\n");
  }
  ~ControlGroup() override { fs::remove_all(folder_); }
  ControlGroup(const ControlGroup&) = delete;
  ControlGroup& operator=(const ControlGroup&) = delete;

  static void write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }
  void in(const std::string& group, const std::string& file, const std::string& text) const {
    write(files_.root / group / file, text);
  }

  fs::path folder_ =
      fs::temp_directory_path() / ("chladni_control_group_" + std::to_string(getpid()));
  ControlGroupFiles files_{folder_ / "cgroup", folder_ / "mount"};
};

TEST_F(ControlGroup, WithoutLimitsGrantsAll) {
  EXPECT_EQ(memory_left_in_group(files_), kUnlimited);
  EXPECT_EQ(processors_of_group(files_), kUnlimited);
  in("slice/unit/leaf", "memory.max", "max\n");
  in("slice/unit/leaf", "memory.current", "1000\n");
  in("slice/unit/leaf", "cpu.max", "max 100000\n");
  EXPECT_EQ(memory_left_in_group(files_), kUnlimited);
  EXPECT_EQ(processors_of_group(files_), kUnlimited);
  EXPECT_EQ(memory_left_in_group({folder_ / "none", folder_ / "none"}), kUnlimited);
}

TEST_F(ControlGroup, IsThatOfTheProcess) {
  in("slice/unit/leaf", "memory.max", "5000\n");
  in("slice/unit/leaf", "memory.current", "1800\n");
  EXPECT_EQ(memory_left_in_group(files_), 3200U);
  in("slice/unit/leaf", "memory.stat", "anon 1000\nfile 800\ninactive_file 700\n");
  EXPECT_EQ(memory_left_in_group(files_), 3900U) << "pages of files that are not in use come back";
  in("slice/unit/leaf", "memory.current", "9000\n");
  in("slice/unit/leaf", "memory.stat", "");
  EXPECT_EQ(memory_left_in_group(files_), 0U);
}

TEST_F(ControlGroup, IsBoundByThoseAbove) {
  in("slice/unit/leaf", "memory.max", "5000\n");
  in("slice/unit/leaf", "memory.current", "100\n");
  in("slice", "memory.max", "3000\n");
  in("slice", "memory.current", "2500\n");
  EXPECT_EQ(memory_left_in_group(files_), 500U);
  in("slice/unit", "cpu.max", "250000 100000\n");
  EXPECT_EQ(processors_of_group(files_), 3U);
  in("", "cpu.max", "50000 100000\n");
  EXPECT_EQ(processors_of_group(files_), 1U);
}

TEST_F(ControlGroup, OutsideOfWhatCanBeSeenIsTheRoot) {
  write(files_.membership, "0::/../../other\n");
  in("", "memory.max", "700\n");
  in("", "memory.current", "300\n");
  EXPECT_EQ(memory_left_in_group(files_), 400U);
}

}  // namespace
}  // namespace chladni
