// Without memory, or on a full disk: what is written or copied is whole or not there.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <vector>

#include "base/error.h"
#include "host/atomic_file.h"
#include "io/bytes/scratch_file.h"
#include "io/json.h"
#include "io/mat.h"
#include "tests/failing_new.h"

namespace chladni::io {
namespace {

namespace fs = std::filesystem;

JsonObject some_object() {
  return {{"a text that is longer than its own place", "another text that is as long"},
          {"inner", JsonObject{{"list", JsonArray{1.0, "a third text that is as long", true}},
                               {"empty", JsonObject{}}}},
          {"number", 3.5}};
}

TEST(Json, ACopyWithoutMemoryLeavesNothingBroken) {
  const Json json = some_object();
  long failures = without_memory(1000, 1, [&] {
    const Json copy = json;  // NOLINT(performance-unnecessary-copy-initialization)
    EXPECT_EQ(text(copy), text(json));
  });
  EXPECT_GT(failures, 5);
  failures = without_memory(1000, 1, [] { EXPECT_EQ(some_object().size(), 3U); });
  EXPECT_GT(failures, 5);
}

class FullDisk : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("chladni_full_" + std::to_string(getpid()));
    fs::create_directory(folder_);
    getrlimit(RLIMIT_FSIZE, &before_);
  }
  void TearDown() override {
    setrlimit(RLIMIT_FSIZE, &before_);
    fs::remove_all(folder_);
  }
  // A limit on the size of files fails a write where a full disk would.
  void limit(rlim_t bytes) const {
    const rlimit small = {bytes, before_.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  }
  [[nodiscard]] auto files_there() const {
    return std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
  }

  fs::path folder_;
  rlimit before_ = {};
};

// libmatio does not tell that a write has failed.
TEST_F(FullDisk, LeavesNoHalfMatFile) {
  const auto file = folder_ / "m.mat";
  const MatFields variables = {{"m", MatValue(Eigen::MatrixXd(Eigen::MatrixXd::Ones(100, 100)))},
                               {"word", MatValue(std::string("text"))}};
  write_atomically(file, "old");
  for (const rlim_t bytes : {rlim_t{1000}, rlim_t{50'000}, rlim_t{80'100}}) {
    limit(bytes);
    EXPECT_THROW(write_mat(file, variables, MatVersion::mat_5), OutOfResources) << bytes;
    setrlimit(RLIMIT_FSIZE, &before_);
    EXPECT_EQ(read_whole(file), "old");
    EXPECT_EQ(files_there(), 1);
  }
  for (const auto version : {MatVersion::mat_5, MatVersion::mat_7_3}) {
    write_mat(file, variables, version);
    EXPECT_GT(fs::file_size(file), 80'000U);
    EXPECT_EQ(files_there(), 1);
  }
}

// The limit of the system on the size of files would end the program by a signal.
TEST_F(FullDisk, IsToldOfAScratchFile) {
  ScratchFile file;
  const std::vector<double> numbers(1000, 1.5);
  limit(1000);
  EXPECT_THROW((void)file.append(numbers.data(), numbers.size()), OutOfResources);
  setrlimit(RLIMIT_FSIZE, &before_);
  const auto at = file.append(numbers.data(), numbers.size());
  std::vector<double> back(numbers.size());
  file.read(at, back.data(), back.size());
  EXPECT_EQ(back, numbers);
}

}  // namespace
}  // namespace chladni::io
