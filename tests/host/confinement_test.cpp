#include "host/confinement.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/capability.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "host/worker.h"

namespace chladni {
namespace {

namespace fs = std::filesystem;

class Confined : public testing::Test {
 protected:
  void SetUp() override {
    const auto support = confinement_support();
    if (support.landlock == 0 || !support.has_filter) GTEST_SKIP() << support.text();
    folder_ = fs::temp_directory_path() / ("chladni_confined_" + std::to_string(getpid()));
    fs::create_directories(folder_);
    std::ofstream(folder_ / "own") << "own";
    std::ofstream(folder_ / "other") << "other";
  }
  void TearDown() override {
    unsetenv("CHLADNI_PROBE");
    unsetenv("CHLADNI_PROBE_FILE");
    if (!folder_.empty()) fs::remove_all(folder_);
  }

  // What the probe prints, or what is said of its end.
  std::string answer(const char* deed, const fs::path& file = {}) const {
    setenv("CHLADNI_PROBE", deed, 1);
    setenv("CHLADNI_PROBE_FILE", file.c_str(), 1);
    try {
      return run_worker(
                 CHLADNI_PROBE_PROGRAM, {}, "",
                 {.time = std::chrono::seconds(20), .confined = true, .files = {folder_ / "own"}})
          .output;
    } catch (const ForbiddenCall& call) {
      return std::string("forbidden: ") + call.what();
    } catch (const WorkerDied& death) {
      return death.what();
    }
  }

  fs::path folder_;
};

testing::AssertionResult says(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "\"" << part << "\" is not in \"" << text << "\"";
}

TEST_F(Confined, ReadsItsOwnFileAndNoOther) {
  EXPECT_EQ(answer("read", folder_ / "own"), "done\n");
  EXPECT_TRUE(says(answer("read", folder_ / "other"), "refused: Permission denied"));
  EXPECT_TRUE(says(answer("read", "/etc/passwd"), "refused: Permission denied"));
  EXPECT_TRUE(says(answer("read", CHLADNI_SOURCE_DIR "/LICENSE"), "refused: Permission denied"));
  EXPECT_TRUE(says(answer("list", folder_), "refused: Permission denied"));
  EXPECT_TRUE(says(answer("list", "/"), "refused: Permission denied"));
  EXPECT_TRUE(says(answer("environment"), "refused: Permission denied"));
}

TEST_F(Confined, ChangesNoFile) {
  for (const char* deed : {"write", "create", "remove"}) {
    for (const char* name : {"own", "other"}) {
      EXPECT_TRUE(says(answer(deed, folder_ / name), "refused: Permission denied")) << deed;
    }
  }
  EXPECT_TRUE(says(answer("create", folder_ / "new"), "refused: Permission denied"));
  EXPECT_FALSE(fs::exists(folder_ / "new"));
  EXPECT_TRUE(fs::exists(folder_ / "own"));
}

TEST_F(Confined, IsStoppedAtTheNetworkAndAtOtherProcesses) {
  for (const char* deed : {"socket", "fork", "shell", "signal", "owner_of_pipe",
                           "owner_by_structure", "owner_by_ioctl", "signal_of_pipe"}) {
    const auto said = answer(deed);
    EXPECT_TRUE(said.starts_with("forbidden: ")) << deed << ": " << said;
    EXPECT_TRUE(says(said, "was stopped: it tried what no reader of a file may do")) << deed;
  }
  EXPECT_TRUE(says(answer("local_socket"), "refused: Permission denied"));
}

// What libraries do must go on to work: threads, and the end by abort().
TEST_F(Confined, MayHaveThreadsAndAbort) {
  EXPECT_EQ(answer("thread"), "a thread\ndone\n");
  EXPECT_TRUE(says(answer("abort"), "died: signal 6"));
}

TEST_F(Confined, HasFewFilesAndCannotRaiseItsLimits) {
  EXPECT_EQ(answer("files"), "61 files\ndone\n");
  EXPECT_TRUE(says(answer("more_files"), "refused: "));
}

TEST_F(Confined, SetsNoLimitsAndNothingOfItsParent) {
  for (const char* deed :
       {"limits_by_address", "limits_of_parent", "processors_of_parent", "scheduler_of_parent"}) {
    EXPECT_TRUE(says(answer(deed), "refused: Operation not permitted")) << deed;
  }
  for (const char* deed : {"own_limits", "own_processors", "own_scheduler", "no_waiting"}) {
    EXPECT_EQ(answer(deed), "done\n") << deed;
  }
}

// Without confinement the probe succeeds: it is not the probe that fails.
TEST_F(Confined, OthersAreNot) {
  for (const char* deed :
       {"socket", "local_socket", "fork", "shell", "more_files", "limits_by_address",
        "limits_of_parent", "processors_of_parent", "scheduler_of_parent", "owner_of_pipe",
        "owner_by_structure", "owner_by_ioctl", "signal_of_pipe"}) {
    setenv("CHLADNI_PROBE", deed, 1);
    EXPECT_TRUE(says(run_worker(CHLADNI_PROBE_PROGRAM, {}, "").output, "done\n")) << deed;
  }
}

// The end of a process that is confined and then acts.
int ending_signal(const std::function<void()>& act) {
  Confinement confinement("/bin/true", {}, std::chrono::seconds(1));
  const pid_t child = fork();
  if (child == 0) {
    if (!confinement.apply()) _exit(1);
    act();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFSIGNALED(status) ? WTERMSIG(status) : -WEXITSTATUS(status);
}

TEST_F(Confined, HasAnEndOfProcessorTimeAndLetsNoFileGrow) {
  EXPECT_EQ(ending_signal([] {}), 0);
  EXPECT_EQ(ending_signal([] {
              while (true) static_cast<void>(getpid());
            }),
            SIGXCPU);
  const int file = open((folder_ / "own").c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  ASSERT_GE(file, 0);
  EXPECT_EQ(ending_signal([&] { static_cast<void>(!write(file, "more", 4)); }), SIGXFSZ);
  close(file);
  EXPECT_EQ(fs::file_size(folder_ / "own"), 3U);
}

TEST(ConfinementSupport, IsSaidInOneLine) {
  EXPECT_EQ((ConfinementSupport{3, true}.text()),
            "no network, no other processes, no files but theirs");
  EXPECT_EQ((ConfinementSupport{0, true}.text()),
            "no network, no other processes; this system has no Landlock");
  EXPECT_EQ((ConfinementSupport{1, false}.text()),
            "no files but theirs; this system has no seccomp");
  EXPECT_EQ((ConfinementSupport{}.text()),
            "limits of time, memory and size alone; this system has no Landlock and seccomp");
}

// Lowers the hard limits of this process below those of a worker, as `ulimit` does, and gives up
// the privilege to raise them again.
void lower_limits() {
  __user_cap_header_struct header = {_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct held[2] = {};
  syscall(SYS_capget, &header, held);
  held[0].effective &= ~(1U << CAP_SYS_RESOURCE);
  held[0].permitted &= ~(1U << CAP_SYS_RESOURCE);
  syscall(SYS_capset, &header, held);
  const rlimit seconds = {10, 10}, files = {20, 20};
  if (setrlimit(RLIMIT_CPU, &seconds) != 0 || setrlimit(RLIMIT_NOFILE, &files) != 0) _exit(2);
}

using ConfinedDeathTest = Confined;

TEST_F(ConfinedDeathTest, KeepsTheLowerLimitsOfItsParent) {
  EXPECT_EXIT(
      {
        lower_limits();
        const auto said = answer("read", folder_ / "own");
        if (said != "done\n") fprintf(stderr, "%s\n", said.c_str());
        _exit(said == "done\n" ? 0 : 1);
      },
      testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace chladni
