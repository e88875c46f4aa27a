// What becomes of launchers and workers that fail. They are scripts: no MPI is needed.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string>
#include <thread>

#include "base/error.h"
#include "base/interrupt.h"
#include "cluster/ranks.h"
#include "fem/assemble.h"
#include "host/worker.h"
#include "mesh/bodies.h"
#include "tests/cluster/exchange_folder.h"

namespace chladni::cluster {
namespace {

using namespace std::chrono_literals;

class Launchers : public ExchangeFolder {
 protected:
  void SetUp() override {
    ExchangeFolder::SetUp();
    program("chladni-slepc", "exit 0");
    setenv("CHLADNI_LIBEXEC", folder_.c_str(), 1);
  }
  void TearDown() override {
    unsetenv("CHLADNI_LIBEXEC");
    ExchangeFolder::TearDown();
  }
  RanksResult solved(const std::string& launcher) const {
    static const fem::System system = fem::assemble(
        mesh::layered(mesh::Plate{0.3, 0.2, 0.01}, 0.1, 1), {fem::isotropic(70e9, 0.33, 2700.0)});
    return modes_by_ranks(system, {.launcher = launcher, .count = 3, .folder = folder_});
  }
  // What a launcher that runs `script` leads to.
  template <typename Error = WorkerDied>
  std::string said(const std::string& script) const {
    try {
      (void)solved(program("launch", script).string() + " -n 2");
    } catch (const Error& e) {
      return e.what();
    }
    ADD_FAILURE() << "no error of that kind";
    return "";
  }
  static void expect_said(const std::string& said, const std::string& part) {
    EXPECT_NE(said.find(part), std::string::npos) << "\"" << said << "\"";
  }
};

TEST_F(Launchers, ThatAreMissingAreNamed) {
  try {
    (void)solved("mpiexec-of-nobody -n 4");
    FAIL();
  } catch (const WorkerDied& e) {
    expect_said(e.what(), "no program mpiexec-of-nobody on the PATH");
  }
  EXPECT_THROW((void)solved((folder_ / "none").string()), WorkerDied);
  EXPECT_THROW((void)solved("  "), InvalidInput);
}

TEST_F(Launchers, WithoutTheWorkerSayWhatToInstall) {
  const fs::path empty = folder_ / "empty";
  fs::create_directory(empty);
  std::string found;
  try {
    fs::remove(folder_ / "chladni-slepc");
    found = worker_path("chladni-slepc").string();  // of this build
  } catch (const WorkerDied&) {
    found.clear();
  }
  if (!found.empty()) GTEST_SKIP() << "this build has the worker: " << found;
  expect_said(said("exit 0"), "packages-cluster.txt");
}

TEST_F(Launchers, GiveTheReasonOfTheRanks) {
  const auto rules = "echo ----------- >&2; ";
  expect_said(said(rules + std::string("echo 'chladni-slepc: rank 1 has no disc' >&2; "
                                       "echo something else >&2; echo ------- >&2; exit 4")),
              "exit status 4: chladni-slepc: rank 1 has no disc");
  expect_said(
      said("echo 'process rank 1 exited on signal 9 (Killed).' >&2; echo ---- >&2; exit 137"),
      "exited on signal 9");
  expect_said(said("exit 3"), "it said nothing");
  expect_said(said("kill -SEGV $$"), "signal 11");
}

TEST_F(Launchers, ThatRefuseAreHelped) {
  expect_said(said("echo 'mpiexec has detected an attempt to run as root.' >&2; exit 1"),
              "launch --allow-run-as-root -n 2\"");
  expect_said(said("echo 'There are not enough slots available' >&2; exit 1"),
              "launch --oversubscribe -n 2\"");
}

TEST_F(Launchers, WithoutMemoryAreToldApart) {
  expect_said(said<OutOfResources>("echo 'chladni-slepc: no memory' >&2; exit 5"), "no memory");
}

// The worker ends well and has written nothing, or nonsense.
TEST_F(Launchers, RepliesThatCannotBeUsedAreRefused) {
  expect_said(said<UnusableReply>("exit 0"), "reply.txt");
  expect_said(said<UnusableReply>("echo nonsense > \"$4/reply.txt\""),
              "expected \"chladni-slepc\"");
}

TEST_F(Launchers, LeaveNoFilesBehind) {
  EXPECT_NE(said("test -s \"$4/stiffness.petsc\" -a -s \"$4/mass.petsc\" || exit 9; exit 4"), "");
  EXPECT_EQ(said("exit 4").find("status 9"), std::string::npos);
  for (const auto& entry : fs::directory_iterator(folder_)) {
    EXPECT_EQ(entry.path().filename().string().find(".ranks"), std::string::npos);
  }
}

// A launcher that is interrupted ends its ranks by itself: it is asked before it is killed.
TEST_F(Launchers, AreAskedToEnd) {
  catch_interrupts();
  const auto mark = folder_ / "ended";
  const auto script = program("launch", "trap 'echo yes > " + mark.string() +
                                            "; exit 1' TERM; while :; do sleep 0.05; done");
  std::thread interrupter([] {
    std::this_thread::sleep_for(500ms);
    std::raise(SIGINT);
  });
  EXPECT_THROW((void)solved(script.string() + " -n 2"), Interrupted);
  interrupter.join();
  EXPECT_TRUE(fs::exists(mark));
}

}  // namespace
}  // namespace chladni::cluster
