// Results that are kept in a folder: what comes back is what was put there, or nothing.
#include "host/cache.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "base/error.h"
#include "base/packed.h"
#include "host/atomic_file.h"
#include "host/loaded_code.h"

namespace chladni {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr std::uintmax_t kMost = 1 << 20;

class Caches : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / ("chladni_cache_" + std::to_string(getpid()) + "_" +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path file(const std::string& name) const { return folder_ / (name + ".kept"); }
  void use(const std::string& name, fs::file_time_type::duration ago) const {
    fs::last_write_time(file(name), fs::file_time_type::clock::now() - ago);
  }

  fs::path folder_;
};

std::string all_bytes() {
  std::string bytes;
  for (int i = 0; i < 3 * 256; ++i) bytes.push_back(static_cast<char>(i));
  return bytes;
}

TEST_F(Caches, GiveBackWhatWasKept) {
  const Cache cache(folder_, kMost);
  EXPECT_FALSE(cache.content("a"));
  EXPECT_EQ(cache.keep("a", all_bytes()), "");
  EXPECT_EQ(cache.keep("empty", ""), "");
  EXPECT_EQ(cache.content("a"), all_bytes());
  EXPECT_EQ(cache.content("empty"), "");
  EXPECT_EQ(cache.keep("a", "anew"), "");
  EXPECT_EQ(Cache(folder_, kMost).content("a"), "anew");
  EXPECT_EQ(cache.names("e"), std::vector<std::string>{"empty"});
  EXPECT_EQ(cache.size().entries, 2U);
}

TEST_F(Caches, GiveNothingOfAFileThatWasDamaged) {
  const Cache cache(folder_, kMost);
  ASSERT_EQ(cache.keep("a", all_bytes()), "");
  const auto good = read_whole(file("a"));
  for (std::size_t at = 0; at < good.size(); at += 7) {
    auto bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 4);
    std::ofstream(file("a"), std::ios::binary) << bad;
    EXPECT_FALSE(cache.content("a")) << "byte " << at;
    EXPECT_FALSE(fs::exists(file("a"))) << "it is not met again";
  }
  for (std::size_t size = 0; size < good.size(); size += 5) {
    std::ofstream(file("a"), std::ios::binary) << good.substr(0, size);
    EXPECT_FALSE(cache.content("a")) << size << " bytes";
  }
  std::ofstream(file("a"), std::ios::binary) << good + "x";
  EXPECT_FALSE(cache.content("a"));
  ASSERT_EQ(cache.keep("a", all_bytes()), "");
  EXPECT_EQ(cache.content("a"), all_bytes());
}

TEST_F(Caches, GiveNothingOfAnEntryUnderAnotherName) {
  const Cache cache(folder_, kMost);
  ASSERT_EQ(cache.keep("a", "of a"), "");
  fs::copy_file(file("a"), file("b"));
  EXPECT_FALSE(cache.content("b"));
  EXPECT_EQ(cache.content("a"), "of a");
}

TEST_F(Caches, LeaveWhatIsNotTheirs) {
  const Cache cache(folder_, 3000);
  fs::create_directories(folder_ / "folder.kept");
  std::ofstream(folder_ / "thesis.tex") << std::string(5000, 'x');
  for (const auto* name : {"a", "b", "c", "d"}) {
    ASSERT_EQ(cache.keep(name, std::string(1000, 'x')), "");
  }
  EXPECT_LE(cache.size().entries, 2U);
  EXPECT_EQ(cache.clear().entries, 2U);
  EXPECT_EQ(cache.size().entries, 0U);
  EXPECT_TRUE(fs::exists(folder_ / "thesis.tex"));
  EXPECT_TRUE(fs::exists(folder_ / "folder.kept"));
}

TEST_F(Caches, LetTheLeastRecentlyUsedGo) {
  const Cache cache(folder_, 3500);
  const std::string content(1000, 'x');
  for (const auto* name : {"a", "b", "c"}) ASSERT_EQ(cache.keep(name, content), "");
  use("a", 3h);
  use("b", 2h);
  use("c", 1h);
  EXPECT_TRUE(cache.content("a"));  // now the most recent one
  ASSERT_EQ(cache.keep("d", content), "");
  EXPECT_EQ(cache.names(""), (std::vector<std::string>{"a", "c", "d"}));
  EXPECT_LE(cache.size().bytes, 3500U);
}

TEST_F(Caches, KeepAsMuchAsTheyMay) {
  const Cache large(folder_, kMost);
  for (const auto* name : {"a", "b"}) ASSERT_EQ(large.keep(name, std::string(1000, 'x')), "");
  use("a", 2h);
  use("b", 1h);
  const auto both = large.size().bytes;
  ASSERT_EQ(Cache(folder_, both).keep("b", std::string(1000, 'y')), "");
  EXPECT_EQ(large.names(""), (std::vector<std::string>{"a", "b"}));
  ASSERT_EQ(Cache(folder_, both - 1).keep("b", std::string(1000, 'z')), "");
  EXPECT_EQ(large.names(""), std::vector<std::string>{"b"});
}

TEST_F(Caches, KeepNothingThatIsLargerThanAll) {
  const Cache cache(folder_, 500);
  EXPECT_NE(cache.keep("a", std::string(1000, 'x')), "");
  EXPECT_EQ(cache.size().entries, 0U);
}

TEST_F(Caches, RemoveWhatAKilledProcessLeft) {
  const Cache cache(folder_, kMost);
  ASSERT_EQ(cache.keep("a", "x"), "");
  const auto left = folder_ / ".b.123-0.kept";
  std::ofstream(left) << "half";
  ASSERT_EQ(cache.keep("c", "x"), "");
  EXPECT_TRUE(fs::exists(left)) << "somebody may be writing it";
  fs::last_write_time(left, fs::file_time_type::clock::now() - 48h);
  ASSERT_EQ(cache.keep("d", "x"), "");
  EXPECT_FALSE(fs::exists(left));
}

TEST_F(Caches, SayWhyTheyCannotKeep) {
  std::ofstream(folder_.string()) << "a file where a folder should be";
  const Cache cache(folder_, kMost);
  EXPECT_NE(cache.keep("a", "x"), "");
  EXPECT_FALSE(cache.content("a"));
  EXPECT_EQ(cache.size().entries, 0U);
  const Cache::Hold hold(cache, "a", {});  // nor can they be locked: work goes on
}

// Two processes, each of which would add one where it finds no entry: one of them finds the
// other's.
TEST_F(Caches, LetOneProcessWorkAtATime) {
  const Cache cache(folder_, kMost);
  const auto worked = [&] {
    const Cache::Hold hold(cache, "a", {});
    if (cache.content("a")) return false;
    std::this_thread::sleep_for(200ms);
    return cache.keep("a", "x").empty();
  };
  std::vector<pid_t> children;
  for (int i = 0; i < 4; ++i) {
    children.push_back(fork());
    if (children.back() == 0) _exit(worked() ? 1 : 0);
  }
  int count = 0;
  for (const pid_t child : children) {
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFEXITED(status));
    count += WEXITSTATUS(status);
  }
  EXPECT_EQ(count, 1);
}

TEST_F(Caches, HoldNothingAfterDeath) {
  const Cache cache(folder_, kMost);
  const pid_t child = fork();
  if (child == 0) {
    const Cache::Hold hold(cache, "a", {});
    kill(getpid(), SIGKILL);
  }
  waitpid(child, nullptr, 0);
  bool waited = false;
  const Cache::Hold hold(cache, "a", [&](auto, double) { waited = true; });
  EXPECT_FALSE(waited);
  const Cache::Hold other(cache, "another", [&](auto, double) { waited = true; });
  EXPECT_FALSE(waited);
}

class CachePlaces : public testing::Test {
 protected:
  void SetUp() override {
    for (const auto* name : {"CHLADNI_CACHE", "CHLADNI_CACHE_GB", "XDG_CACHE_HOME"}) unsetenv(name);
    setenv("HOME", "/home/somebody", 1);
  }
};

TEST_F(CachePlaces, FollowTheEnvironment) {
  EXPECT_EQ(cache_place().folder, "/home/somebody/.cache/chladni");
  setenv("XDG_CACHE_HOME", "relative", 1);
  EXPECT_EQ(cache_place().folder, "/home/somebody/.cache/chladni");
  setenv("XDG_CACHE_HOME", "/x", 1);
  EXPECT_EQ(cache_place().folder, "/x/chladni");
  EXPECT_EQ(cache_place().most_bytes, 4000000000U);
  setenv("CHLADNI_CACHE", "/y", 1);
  setenv("CHLADNI_CACHE_GB", "0.5", 1);
  EXPECT_EQ(cache_place().folder, "/y");
  EXPECT_EQ(cache_place().most_bytes, 500000000U);
  setenv("CHLADNI_CACHE", "off", 1);
  EXPECT_TRUE(cache_place().folder.empty());
  EXPECT_EQ(cache_place().note, "");
}

TEST_F(CachePlaces, SayWhatTheyCannotUse) {
  setenv("CHLADNI_CACHE", "beside", 1);
  EXPECT_TRUE(cache_place().folder.empty());
  EXPECT_NE(cache_place().note.find("beside"), std::string::npos);
  setenv("CHLADNI_CACHE", "/y", 1);
  for (const auto* size : {"much", "-1", "0", "nan", "4 GB", "1e30"}) {
    setenv("CHLADNI_CACHE_GB", size, 1);
    EXPECT_EQ(cache_place().most_bytes, 4000000000U) << size;
    EXPECT_NE(cache_place().note.find(size), std::string::npos);
  }
}

TEST(PackedValues, ComeBackInTheirOrder) {
  const Eigen::MatrixXd matrix = (Eigen::MatrixXd(2, 3) << 1, 2, 3, 4, 5, -0.0).finished();
  Packed to;
  to.add(3).add("text").add(matrix).add(true).add(std::vector<std::string>{"", "b"});
  to.add(Eigen::MatrixXd(0, 4)).add(-1.5);
  Unpacked from(to.bytes());
  EXPECT_EQ(from.number<int>(), 3);
  EXPECT_EQ(from.text(), "text");
  EXPECT_EQ(from.array<Eigen::MatrixXd>(), matrix);
  EXPECT_TRUE(from.number<bool>());
  EXPECT_EQ(from.texts(), (std::vector<std::string>{"", "b"}));
  EXPECT_EQ(from.array<Eigen::MatrixXd>().cols(), 4);
  EXPECT_EQ(from.number<double>(), -1.5);
  EXPECT_TRUE(from.is_at_end());
}

TEST(PackedValues, DifferWhereTextsAreDividedDifferently) {
  EXPECT_NE(Packed().add("ab").add("c").bytes(), Packed().add("a").add("bc").bytes());
}

// Cut anywhere, or with sizes that are not theirs, they are refused without a large allocation.
TEST(PackedValues, AreRefusedWhereTheyAreCut) {
  const auto bytes = Packed().add(Eigen::MatrixXd::Ones(3, 3).eval()).add("name").bytes();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    Unpacked from(std::string_view(bytes).substr(0, size));
    const auto take = [&] {
      static_cast<void>(from.array<Eigen::MatrixXd>());
      static_cast<void>(from.text());
    };
    EXPECT_THROW(take(), InvalidInput) << size;
  }
  for (const std::int64_t rows : {std::int64_t{-1}, std::int64_t{1} << 62, std::int64_t{4}}) {
    const auto forged = Packed().add(rows).add(std::int64_t{8}).add(1.0).bytes();
    EXPECT_THROW(static_cast<void>(Unpacked(forged).array<Eigen::MatrixXd>()), InvalidInput);
    EXPECT_THROW(static_cast<void>(Unpacked(forged).array<Eigen::VectorXd>()), InvalidInput);
    EXPECT_THROW(static_cast<void>(Unpacked(Packed().add(rows).bytes()).text()), InvalidInput);
  }
}

TEST(LoadedCode, NamesThisProgramAndStaysTheSame) {
  EXPECT_NE(loaded_code().find("chladni="), std::string::npos);
  EXPECT_NE(loaded_code().find("libc.so"), std::string::npos);
  EXPECT_EQ(loaded_code(), std::string(loaded_code()));
}

}  // namespace
}  // namespace chladni
