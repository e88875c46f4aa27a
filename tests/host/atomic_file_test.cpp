#include "host/atomic_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <stdexcept>

#include "base/error.h"
#include "tests/sanitizer.h"

namespace chladni {
namespace {

namespace fs = std::filesystem;

class AtomicFile : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::temp_directory_path() / ("chladni_atomic_" + std::to_string(getpid()));
    fs::create_directory(folder);
  }
  void TearDown() override { fs::remove_all(folder); }
  [[nodiscard]] auto files_there() const {
    return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
  }
  fs::path folder;
};

TEST_F(AtomicFile, HoldsWhatWasWritten) {
  const std::string bytes("a\0b\n\xff", 5);
  write_atomically(folder / "f.bin", bytes);
  EXPECT_EQ(read_whole(folder / "f.bin"), bytes);
  EXPECT_EQ(files_there(), 1);
}

TEST_F(AtomicFile, KeepsTheOldFileWhenFillingFails) {
  write_atomically(folder / "f.txt", "old");
  EXPECT_THROW(write_atomically(folder / "f.txt",
                                [](std::ostream& out) {
                                  out << "half";
                                  throw std::runtime_error("power cut");
                                }),
               std::runtime_error);
  EXPECT_EQ(read_whole(folder / "f.txt"), "old");
  EXPECT_EQ(files_there(), 1);
}

// A limit on the size of files fails a write where a full disk would (EFBIG for ENOSPC).
TEST_F(AtomicFile, SaysThatTheDiskIsFullAndKeepsTheOldFile) {
  write_atomically(folder / "f.txt", "old");
  rlimit before = {};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small = {100000, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  std::string said;
  try {
    write_atomically(folder / "f.txt", std::string(1000000, 'x'));
  } catch (const OutOfResources& e) {
    said = e.what();
  }
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_NE(said.find("f.txt: cannot be written"), std::string::npos) << said;
  EXPECT_EQ(read_whole(folder / "f.txt"), "old");
  EXPECT_EQ(files_there(), 1);
}

TEST_F(AtomicFile, RefusesAFolderThatCannotBeWritten) {
  // Root may write anywhere but into /proc.
  EXPECT_THROW(write_atomically("/proc/chladni.txt", "x"), InvalidInput);
  write_atomically(folder / "f.txt", "x");
  EXPECT_THROW(write_atomically(folder / "f.txt" / "g.txt", "x"), InvalidInput);
}

TEST_F(AtomicFile, ReplacesNothingButRegularFiles) {
  fs::create_directory(folder / "d");
  EXPECT_THROW(write_atomically(folder / "d", "x"), InvalidInput);
  EXPECT_THROW(write_atomically(folder / "", "x"), InvalidInput);
  EXPECT_THROW(write_atomically("/dev/full", "x"), InvalidInput);
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(AtomicFile, WritesBlocksAndSingleBytesAlike) {
  std::string expected;
  write_atomically(folder / "f.txt", [&expected](std::ostream& out) {
    for (int i = 0; i < 40000; ++i) {
      const std::string piece(static_cast<std::size_t>(i % 13), static_cast<char>('a' + i % 26));
      out << piece << '\n' << i;
      expected += piece + '\n' + std::to_string(i);
    }
    const std::string block(200000, 'z');
    out << block << "end";
    expected += block + "end";
  });
  EXPECT_TRUE(read_whole(folder / "f.txt") == expected);
}

TEST_F(AtomicFile, LeavesNothingWhenALibraryFails) {
  EXPECT_THROW(write_atomically_at(folder / "mesh.vtu",
                                   [](const fs::path& temporary) {
                                     std::ofstream(temporary) << "half";
                                     throw std::runtime_error("writer failed");
                                   }),
               std::runtime_error);
  EXPECT_EQ(files_there(), 0);
}

TEST_F(AtomicFile, SaysThatAFillFailed) {
  EXPECT_THROW(
      write_atomically(folder / "f.txt", [](std::ostream& out) { out.setstate(std::ios::badbit); }),
      OutOfResources);
  EXPECT_EQ(files_there(), 0);
}

TEST_F(AtomicFile, NamesTheFolderThatIsNotThere) {
  try {
    write_atomically(folder / "missing" / "f.txt", "x");
    FAIL();
  } catch (const InvalidInput& e) {
    EXPECT_NE(std::string(e.what()).find("missing does not exist"), std::string::npos);
  }
}

TEST_F(AtomicFile, GivesTheTemporaryTheSameEnding) {
  write_atomically_at(folder / "mesh.vtu", [](const fs::path& temporary) {
    EXPECT_EQ(temporary.extension(), ".vtu");
    std::ofstream(temporary) << "x";
  });
  EXPECT_EQ(read_whole(folder / "mesh.vtu"), "x");
}

TEST_F(AtomicFile, TellsAMachineThatFailsFromAFileThatDoes) {
  if (!kAddressesMayBeLimited) GTEST_SKIP() << "a sanitizer needs files of its own";
  write_atomically(folder / "f.txt", "x");
  rlimit before = {};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit none = {0, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &none), 0);
  EXPECT_THROW((void)read_whole(folder / "f.txt"), OutOfResources);
  setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_THROW((void)read_whole(folder / "none.txt"), InvalidInput);
}

TEST_F(AtomicFile, ReadsOnlyRegularFilesUpToALimit) {
  write_atomically(folder / "f.txt", "12345");
  EXPECT_THROW((void)read_whole(folder / "f.txt", 4), InvalidInput);
  EXPECT_EQ(read_whole(folder / "f.txt", 5), "12345");
  EXPECT_THROW((void)read_whole(folder), InvalidInput);
  EXPECT_THROW((void)read_whole("/dev/zero"), InvalidInput);
  EXPECT_THROW((void)read_whole(folder / "none"), InvalidInput);
  ASSERT_EQ(mkfifo((folder / "fifo").c_str(), 0600), 0);
  EXPECT_THROW((void)read_whole(folder / "fifo"), InvalidInput);
}

}  // namespace
}  // namespace chladni
