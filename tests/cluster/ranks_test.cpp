// Modes by real ranks of MPI. Skipped aloud where this build has no chladni-slepc or the machine no
// mpiexec.
#include "cluster/ranks.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <string>
#include <thread>

#include "base/error.h"
#include "base/interrupt.h"
#include "fem/assemble.h"
#include "host/worker.h"
#include "mesh/bodies.h"
#include "tests/cluster/exchange_folder.h"

namespace chladni::cluster {
namespace {

using namespace std::chrono_literals;

// Why there are no ranks here; empty where there are.
std::string missing() {
  if (!program_on_path("mpiexec")) return "no mpiexec on the PATH";
  try {
    (void)worker_path("chladni-slepc");
  } catch (const WorkerDied& e) {
    return e.what();
  }
  return "";
}

// More ranks than cores, as root too: what a test machine is.
std::string ranks(int count) {
  return "mpiexec --allow-run-as-root --oversubscribe -n " + std::to_string(count);
}

// Processes of the program, by the name of its executable.
int workers_alive() {
  int count = 0;
  const auto program = fs::canonical(worker_path("chladni-slepc"));
  for (const auto& entry : fs::directory_iterator("/proc")) {
    std::error_code fault;
    const auto exe = fs::read_symlink(entry.path() / "exe", fault);
    std::ifstream line(entry.path() / "cmdline");
    std::string all((std::istreambuf_iterator<char>(line)), {});
    const auto mine =
        fs::temp_directory_path().string() + "/chladni_cluster_" + std::to_string(getpid());
    if (!fault && exe == program && all.find(mine) != std::string::npos) ++count;
  }
  return count;
}

fem::System plate(double edge, int order = 2) {
  return fem::assemble(mesh::with_order(mesh::layered(mesh::Plate{0.3, 0.2, 0.01}, edge, 1), order),
                       {fem::isotropic(70e9, 0.33, 2700.0)});
}

class Ranks : public ExchangeFolder {
 protected:
  void SetUp() override {
    if (const auto why = missing(); !why.empty()) GTEST_SKIP() << why;
    ExchangeFolder::SetUp();
  }
  RanksResult solved(const fem::System& system, RanksOptions options, int count) const {
    options.launcher = ranks(count);
    options.folder = folder_;
    return modes_by_ranks(system, options);
  }
  static double distance(const fem::ModesResult& a, const fem::ModesResult& b) {
    const auto rigid = a.modes.rigid_count;
    EXPECT_EQ(a.modes.rigid_count, b.modes.rigid_count);
    EXPECT_EQ(a.modes.mode_count(), b.modes.mode_count());
    const auto flexible = std::min(a.modes.mode_count(), b.modes.mode_count()) - rigid;
    return (a.modes.frequency_hz.segment(rigid, flexible)
                .cwiseQuotient(b.modes.frequency_hz.segment(rigid, flexible))
                .array() -
            1.0)
        .abs()
        .maxCoeff();
  }
};

// SLEPc and MUMPS share no code with our Lanczos and our count.
TEST_F(Ranks, FindOurFrequencies) {
  const auto system = plate(0.05);
  const auto own = fem::modes(system, {.count = 10});
  for (const int count : {1, 2, 4}) {
    const auto found = solved(system, {.count = 10}, count);
    EXPECT_LT(distance(found.modes, own), 1e-9) << count;
    EXPECT_LT((found.modes.modes.shapes - own.modes.shapes).cwiseAbs().maxCoeff(),
              1e-6 * own.modes.shapes.cwiseAbs().maxCoeff());
    EXPECT_TRUE(found.modes.summary.complete);
    EXPECT_EQ(found.modes.summary.counted, found.modes.summary.found);
    EXPECT_GE(found.modes.summary.counted, 16);
    EXPECT_LT(found.modes.summary.residual.maxCoeff(), 1e-9);
    EXPECT_EQ(found.ranks.peak_bytes.size(), static_cast<std::size_t>(count));
    EXPECT_GT(found.ranks.peak_bytes.front(), 1e7);
  }
}

// A square plate has repeated modes; they come whole and in our orientation.
TEST_F(Ranks, FindRepeatedModes) {
  const auto system =
      fem::assemble(mesh::with_order(mesh::layered(mesh::Plate{0.2, 0.2, 0.01}, 0.05, 1), 2),
                    {fem::isotropic(70e9, 0.33, 2700.0)});
  const auto own = fem::modes(system, {.count = 5});
  const auto found = solved(system, {.count = 5}, 2);
  EXPECT_LT(distance(found.modes, own), 1e-9);
  EXPECT_EQ(found.modes.summary.clusters.size(), own.summary.clusters.size());
}

// Supports leave no rigid-body motion.
TEST_F(Ranks, FindModesOfAHeldBody) {
  const auto body = mesh::with_order(mesh::layered(mesh::Plate{0.3, 0.2, 0.01}, 0.05, 1), 2);
  const fem::Support held{.patch = body.patch_names.front(), .x = true, .y = true, .z = true};
  const auto clamped = fem::assemble(body, {fem::isotropic(70e9, 0.33, 2700.0)}, {held});
  EXPECT_EQ(clamped.rigid.cols(), 0);
  EXPECT_LT(distance(solved(clamped, {.count = 6}, 2).modes, fem::modes(clamped, {.count = 6})),
            1e-9);
}

TEST_F(Ranks, FindAllModesBelowAFrequency) {
  const auto system = plate(0.05);
  const auto own = fem::modes(system, {.count = 12});
  const double hz = 0.5 * (own.modes.frequency_hz(13) + own.modes.frequency_hz(14));
  const auto found = solved(system, {.up_to_hz = hz}, 2);
  EXPECT_EQ(found.modes.modes.mode_count(), 14);
  EXPECT_NEAR(found.modes.modes.frequency_hz(13) / own.modes.frequency_hz(13), 1.0, 1e-9);
  // Below the first flexible one: at least that one.
  EXPECT_GE(solved(system, {.up_to_hz = 1.0}, 1).modes.modes.mode_count(), 7);
}

// The bound is guessed; from far below and from far above the same modes come.
TEST_F(Ranks, NeedNoGoodGuess) {
  const auto system = plate(0.06);
  const auto own = fem::modes(system, {.count = 6});
  for (const double factor : {0.01, 3.0}) {
    const double guess = factor * own.modes.frequency_hz(11);
    EXPECT_LT(distance(solved(system, {.count = 6, .guess_hz = guess}, 1).modes, own), 1e-9);
  }
}

// One rank is killed in mid-run: an error that says so, and no rank and no file is left.
TEST_F(Ranks, ThatDieAreTold) {
  const auto system = plate(0.012);
  std::thread killer([] {
    const auto until = std::chrono::steady_clock::now() + 120s;
    while (workers_alive() == 0 && std::chrono::steady_clock::now() < until) {
      std::this_thread::sleep_for(10ms);
    }
    std::this_thread::sleep_for(300ms);
    const auto program = fs::canonical(worker_path("chladni-slepc"));
    for (const auto& entry : fs::directory_iterator("/proc")) {
      std::error_code fault;
      if (fs::read_symlink(entry.path() / "exe", fault) != program || fault) continue;
      std::ifstream line(entry.path() / "cmdline");
      const std::string all((std::istreambuf_iterator<char>(line)), {});
      const auto mine = "chladni_cluster_" + std::to_string(getpid());
      if (all.find(mine) == std::string::npos) continue;
      kill(std::stoi(entry.path().filename().string()), SIGKILL);
      break;
    }
  });
  try {
    (void)solved(system, {.count = 40}, 2);
    ADD_FAILURE() << "the ranks ended well";
  } catch (const WorkerDied& e) {
    EXPECT_NE(std::string(e.what()).find("signal 9"), std::string::npos) << e.what();
  }
  killer.join();
  EXPECT_EQ(workers_alive(), 0);
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(Ranks, EndWithCtrlC) {
  const auto system = plate(0.012);
  catch_interrupts();
  std::thread user([] {
    const auto until = std::chrono::steady_clock::now() + 120s;
    while (workers_alive() == 0 && std::chrono::steady_clock::now() < until) {
      std::this_thread::sleep_for(10ms);
    }
    std::raise(SIGINT);
  });
  EXPECT_THROW((void)solved(system, {.count = 40}, 2), Interrupted);
  user.join();
  for (int i = 0; i < 100 && workers_alive() > 0; ++i) std::this_thread::sleep_for(50ms);
  EXPECT_EQ(workers_alive(), 0);
  EXPECT_TRUE(fs::is_empty(folder_));
}

}  // namespace
}  // namespace chladni::cluster
