#include "base/worker.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>

#include "base/error.h"
#include "base/interrupt.h"

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

TEST(Worker, EchoesMoreThanAPipeHolds) {
  std::string input(50U << 20U, 'x');
  input.back() = 'y';
  const auto result = run_worker("/bin/cat", {}, input);
  EXPECT_TRUE(result.output == input);
}

TEST(Worker, NeedNotReadItsInput) {
  EXPECT_EQ(run_worker("/bin/echo", {"done"}, std::string(1U << 20U, 'x')).output, "done\n");
}

TEST(Worker, KeepsItsErrors) {
  EXPECT_EQ(run_worker("/bin/sh", {"-c", "echo careful >&2"}, "").errors, "careful\n");
}

TEST(Worker, DeathSaysTheSignalAndTheLastWord) {
  const auto said = death({"-c", "echo 'bad facet 7' >&2; kill -ABRT $$"});
  EXPECT_NE(said.find("signal 6"), std::string::npos) << said;
  EXPECT_NE(said.find("bad facet 7"), std::string::npos) << said;
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
  EXPECT_EQ(worker_path("base_worker_test").filename(), "base_worker_test");  // beside this program
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
