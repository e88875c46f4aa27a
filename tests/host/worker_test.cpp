#include "host/worker.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include "base/error.h"
#include "base/interrupt.h"
#include "tests/sanitizer.h"

namespace chladni {
namespace {

using std::chrono::seconds;

std::string death(const std::vector<std::string>& script, const WorkerLimits& limits = {}) {
  try {
    (void)run_worker("/bin/sh", script, "", limits);
  } catch (const WorkerDied& e) {
    return e.what();
  }
  return "";
}

TEST(Worker, AnyStatusButNoughtIsAFailure) {
  EXPECT_NO_THROW((void)run_worker("/bin/true", {}, ""));
  EXPECT_THROW((void)run_worker("/bin/false", {}, ""), WorkerDied);  // 1
}

TEST(Worker, EchoesMoreThanAPipeHolds) {
  std::string input(50U << 20U, 'x');
  input.back() = 'y';
  const auto result = run_worker("/bin/cat", {}, input);
  EXPECT_TRUE(result.output == input);
}

TEST(Worker, NeedNotReadItsInput) {
  EXPECT_EQ(run_worker("/bin/echo", {"done"}, std::string(1U << 20U, 'x')).output, "done\n");
}

std::ptrdiff_t open_descriptors() {
  const std::filesystem::directory_iterator all("/proc/self/fd");
  return std::distance(begin(all), end(all));
}

TEST(Worker, LeavesNoDescriptorOpen) {
  const auto before = open_descriptors();
  for (int run = 0; run < 3; ++run) {
    EXPECT_EQ(run_worker("/bin/cat", {}, "x").output, "x");
    EXPECT_THROW((void)run_worker("/bin/false", {}, "x"), WorkerDied);
    EXPECT_THROW((void)run_worker("/not/there", {}, "x"), WorkerDied);
  }
  EXPECT_EQ(open_descriptors(), before);
}

TEST(Worker, KeepsItsErrors) {
  EXPECT_EQ(run_worker("/bin/sh", {"-c", "echo careful >&2"}, "").errors, "careful\n");
}

TEST(Worker, DeathSaysTheSignalAndTheLastWord) {
  const auto said = death({"-c", "echo 'bad facet 7' >&2; kill -ABRT $$"});
  EXPECT_NE(said.find("signal 6"), std::string::npos) << said;
  EXPECT_NE(said.find("bad facet 7"), std::string::npos) << said;
}

// OpenCASCADE and VTK colour what they print, whatever reads it.
TEST(Worker, DeathSaysNoColours) {
  const auto said =
      death({"-c", R"(printf '\033[31;1mbad face 3\033[0m\n\033[0m\n\n' >&2; exit 4)"});
  EXPECT_TRUE(said.ends_with("exit status 4: bad face 3")) << said;
}

TEST(Worker, DeathSaysTheExitStatus) {
  EXPECT_NE(death({"-c", "exit 9"}).find("exit status 9"), std::string::npos);
}

TEST(Worker, IsStoppedAfterItsTimeWithAllItStarted) {
  const auto start = std::chrono::steady_clock::now();
  const auto said = death({"-c", "sleep 30 & sleep 30"}, {.time = seconds(1)});
  EXPECT_NE(said.find("within 1 s"), std::string::npos) << said;
  EXPECT_LT(std::chrono::steady_clock::now() - start, seconds(5));
}

// What has others to end is asked first, and killed where it does not end.
TEST(Worker, MayBeAskedToEndBeforeItIsKilled) {
  const auto mark =
      std::filesystem::temp_directory_path() / ("chladni_asked_" + std::to_string(getpid()));
  const auto script =
      "trap 'echo yes > " + mark.string() + "; exit 1' TERM; " + "while :; do sleep 0.05; done";
  const auto start = std::chrono::steady_clock::now();
  EXPECT_NE(death({"-c", script}, {.time = seconds(1)}), "");
  EXPECT_FALSE(std::filesystem::exists(mark));
  EXPECT_NE(death({"-c", script}, {.time = seconds(1), .grace = seconds(10)}), "");
  EXPECT_TRUE(std::filesystem::remove(mark));
  const std::string deaf = "trap '' TERM; while :; do sleep 0.05; done";
  EXPECT_NE(death({"-c", deaf}, {.time = seconds(1), .grace = seconds(1)}), "");
  EXPECT_LT(std::chrono::steady_clock::now() - start, seconds(15));
}

TEST(Worker, ProgramsAreFoundOnThePath) {
  EXPECT_EQ(program_on_path("sh")->filename(), "sh");
  EXPECT_EQ(program_on_path("/bin/sh"), std::filesystem::path("/bin/sh"));
  for (const auto* name : {"", "no-such-program", "/bin/no-such-program", "/bin", "/etc/passwd"}) {
    EXPECT_FALSE(program_on_path(name)) << name;
  }
}

TEST(Worker, IsHeldToItsMemory) {
  const auto script = "x=0123456789abcdef; while :; do x=$x$x; done";
  EXPECT_NE(death({"-c", script}, {.time = seconds(20), .memory_bytes = 64U << 20U}), "");
}

TEST(Worker, DyingWithInputUnreadIsNoSignalForUs) {
  try {
    (void)run_worker("/bin/sh", {"-c", "exec <&-; kill -SEGV $$"}, std::string(4U << 20U, 'x'));
    FAIL();
  } catch (const WorkerDied& e) {
    EXPECT_NE(std::string(e.what()).find("sh died: signal 11"), std::string::npos) << e.what();
  }
}

TEST(Worker, KeepsTheLastOfManyErrors) {
  const auto errors =
      run_worker("/bin/sh", {"-c", "yes complaint | head -c 300000 >&2; echo last >&2"}, "").errors;
  EXPECT_EQ(errors.size(), 65536U);
  EXPECT_TRUE(errors.ends_with("last\n"));
}

TEST(Worker, ThatBabblesIsStoppedAtTheLimitAndNamed) {
  const auto start = std::chrono::steady_clock::now();
  try {
    (void)run_worker("/usr/bin/yes", {}, "", {.output_bytes = 10'000'000});
    FAIL();
  } catch (const UnusableReply& e) {
    const std::string said = e.what();
    EXPECT_NE(said.find("yes was stopped: it wrote more than the 10000000 bytes"), said.npos)
        << said;
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, seconds(20));
}

TEST(Worker, MayWriteAllThatItsReplyMayHave) {
  const WorkerLimits limits{.output_bytes = 300'000};
  const std::string script = "yes | head -c 300000";
  EXPECT_EQ(run_worker("/bin/sh", {"-c", script}, "", limits).output.size(), 300'000U);
  EXPECT_THROW((void)run_worker("/bin/sh", {"-c", script + "; echo"}, "", limits), UnusableReply);
}

// A quarter of the memory that there is bounds what is kept, whatever the caller allows.
TEST(WorkerDeathTest, ThatBabblesLeavesTheParentItsMemory) {
  if (!kAddressesMayBeLimited) GTEST_SKIP() << "a sanitizer needs all addresses";
  const auto babble = [] {
    const rlimit most = {std::size_t{1} << 30U, std::size_t{1} << 30U};
    setrlimit(RLIMIT_AS, &most);
    try {
      (void)run_worker("/usr/bin/yes", {}, "");
    } catch (const UnusableReply& e) {
      std::_Exit(std::string(e.what()).starts_with("yes was stopped") ? 7 : 8);
    }
    std::_Exit(9);
  };
  EXPECT_EXIT(babble(), testing::ExitedWithCode(7), "");
}

TEST(Worker, WhatItLeftBehindMayNotBabbleOn) {
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(run_worker("/bin/sh", {"-c", "yes >&2 & echo done"}, "").output, "done\n");
  EXPECT_LT(std::chrono::steady_clock::now() - start, seconds(5));
}

TEST(Worker, ThatIsTriedMayAnswerAsItLikes) {
  EXPECT_NO_THROW(try_worker("/bin/true"));
  EXPECT_NO_THROW(try_worker("/bin/false"));
  EXPECT_THROW(try_worker("/nowhere/mesher"), WorkerDied);
}

// A parent may ignore SIGCHLD, and so may what it starts: the system then tells of no end.
TEST(WorkerDeathTest, EndsAlsoWhereItsEndIsNotTold) {
  const auto attempt = [] {
    std::signal(SIGCHLD, SIG_IGN);
    const auto start = std::chrono::steady_clock::now();
    try {
      try_worker("/bin/true");
    } catch (const WorkerDied& e) {
      const bool soon = std::chrono::steady_clock::now() - start < seconds(5);
      std::_Exit(soon && std::string(e.what()).find("SIGCHLD") != std::string::npos ? 7 : 8);
    }
    std::_Exit(9);
  };
  EXPECT_EXIT(attempt(), testing::ExitedWithCode(7), "");
}

// The streams of the worker would else overwrite the ends of its pipes and its rules.
TEST(WorkerDeathTest, NeedsNoStandardStreamsOfItsParent) {
  const auto attempt = [] {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) close(stream);
    for (const bool confined : {false, true}) {
      const auto said = run_worker("/bin/cat", {}, "echo", {.confined = confined}).output;
      if (said != "echo") std::_Exit(8);
    }
    std::_Exit(7);
  };
  EXPECT_EXIT(attempt(), testing::ExitedWithCode(7), "");
}

TEST(Worker, ThatLacksALibraryDoesNotStart) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("chladni_worker_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const auto program = folder / "lacking";
  std::ofstream(program)
      << "#!/bin/sh\necho 'error while loading shared libraries' >&2\nexit 127\n";
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  try {
    try_worker(program);
    ADD_FAILURE();
  } catch (const WorkerDied& e) {
    EXPECT_NE(std::string(e.what()).find("loading shared libraries"), std::string::npos)
        << e.what();
  }
  std::filesystem::remove_all(folder);
}

TEST(Worker, AReplyThatCannotBeReadIsTheWorkersFault) {
  const auto read = []() -> int { throw InvalidInput("expected an array"); };
  try {
    (void)reply_of("/bin/chladni-mat", read);
    FAIL();
  } catch (const WorkerDied& e) {
    EXPECT_NE(
        std::string(e.what()).find("chladni-mat gave a reply that cannot be used: expected an"),
        std::string::npos);
  }
}

TEST(Worker, DoesNotWaitForWhatItLeftBehind) {
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(run_worker("/bin/sh", {"-c", "sleep 30 & echo done"}, "").output, "done\n");
  EXPECT_LT(std::chrono::steady_clock::now() - start, seconds(5));
}

TEST(Worker, IsEndedByCtrlC) {
  catch_interrupts();
  std::thread user([] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    std::raise(SIGINT);
  });
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THROW((void)run_worker("/bin/sleep", {"30"}, ""), Interrupted);
  EXPECT_LT(std::chrono::steady_clock::now() - start, seconds(5));
  user.join();
  catch_interrupts();  // forget it
}

TEST(WorkerPath, PrefersTheChosenFolder) {
  const char* before = std::getenv("CHLADNI_LIBEXEC");
  const std::string kept = before == nullptr ? "" : before;
  setenv("CHLADNI_LIBEXEC", "/bin", 1);
  EXPECT_EQ(worker_path("sh"), "/bin/sh");
  setenv("CHLADNI_LIBEXEC", kept.c_str(), 1);
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe");
  const std::filesystem::path here = self.parent_path();
  EXPECT_EQ(worker_path(self.filename().string()), self);  // beside this program
  EXPECT_THROW((void)worker_path("nowhere_to_be_found"), WorkerDied);
  std::filesystem::create_directories(here / "added");
  std::filesystem::copy_file("/bin/true", here / "added" / "nowhere_to_be_found",
                             std::filesystem::copy_options::overwrite_existing);
  add_worker_folder(here / "added");
  EXPECT_EQ(worker_path("nowhere_to_be_found"), here / "added" / "nowhere_to_be_found");
  std::filesystem::remove_all(here / "added");
}

TEST(Worker, ThatIsNotThereIsNamed) {
  try {
    (void)run_worker("/nowhere/mesher", {}, "");
    FAIL();
  } catch (const WorkerDied& e) {
    EXPECT_NE(std::string(e.what()).find("/nowhere/mesher"), std::string::npos);
  }
  try {
    (void)worker_path("chladni-nonesuch");
    FAIL();
  } catch (const WorkerDied& e) {
    EXPECT_NE(std::string(e.what()).find("CHLADNI_LIBEXEC"), std::string::npos);
  }
}

}  // namespace
}  // namespace chladni
