#include "cluster/ranks.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <system_error>

#include "base/error.h"
#include "base/text_stream.h"
#include "base/turn.h"
#include "cluster/reply.h"
#include "fem/given_modes.h"
#include "host/descriptor.h"
#include "host/folder.h"
#include "host/worker.h"
#include "io/matrix.h"

namespace chladni::cluster {
namespace {

namespace fs = std::filesystem;

constexpr auto kLongest = std::chrono::hours(24 * 365);
constexpr auto kGrace = std::chrono::seconds(5);  // in which a launcher ends ranks elsewhere
constexpr double kBeyond = 1.004;                 // over up_to_hz: a cluster is not cut there
constexpr int kMoreModes = 3;                     // above those wanted: the last cluster is whole
constexpr int kOutOfMemory = 5;                   // exit status of chladni-slepc

// The files that K, M and the modes go through.
class Exchange {
 public:
  explicit Exchange(const fs::path& parent) {
    static std::atomic<unsigned> folders = 0;
    folder_ = fs::absolute(parent.empty() ? fs::temp_directory_path() : parent) /
              fmt::format(".ranks.{}-{}", getpid(), folders++);
    std::error_code fault;
    fs::create_directory(folder_, fault);
    if (fault) {
      throw_path_error(fault.value(),
                       folder_.string() + ": no such folder can be made for the ranks");
    }
  }
  ~Exchange() { remove_whole(folder_); }
  Exchange(const Exchange&) = delete;
  Exchange& operator=(const Exchange&) = delete;
  Exchange(Exchange&&) = delete;
  Exchange& operator=(Exchange&&) = delete;

  [[nodiscard]] const fs::path& folder() const { return folder_; }

 private:
  fs::path folder_;
};

struct Launch {
  fs::path program;
  std::vector<std::string> arguments;  // those of the launcher, then chladni-slepc
};

Launch launch_of(const std::string& launcher) {
  TextReader stream(launcher);
  Launch launch;
  std::string name;
  require(static_cast<bool>(stream >> name),
          "the engine is empty; expected what starts the ranks, such as \"mpiexec -n 4\"");
  for (std::string word; stream >> word;) launch.arguments.push_back(word);
  const auto program = program_on_path(name);
  if (!program) {
    throw WorkerDied(fmt::format(
        "the engine \"{}\": there is no program {}{}; install MPI (packages-cluster.txt), load its "
        "module, or leave out the engine",
        launcher, name, name.find('/') == std::string::npos ? " on the PATH" : ""));
  }
  launch.program = *program;
  try {
    launch.arguments.push_back(worker_path("chladni-slepc").string());
  } catch (const WorkerDied& missing) {
    throw WorkerDied(fmt::format(
        "the engine \"{}\" needs the program chladni-slepc: {}; it is built where SLEPc is "
        "installed (packages-cluster.txt)",
        launcher, missing.what()));
  }
  return launch;
}

// The line of what was said that tells most.
std::string reason_in(const std::string& errors) {
  TextReader stream(errors);
  std::string own, signal, last;
  for (std::string line; std::getline(stream, line);) {
    const bool is_rule = line.find_first_not_of("-= \t\r") == std::string::npos;
    if (is_rule) continue;
    if (own.empty() && line.starts_with("chladni-slepc: ")) own = line;
    if (signal.empty() && line.find(" signal ") != std::string::npos) signal = line;
    last = line;
  }
  for (const auto& line : {own, signal, last}) {
    if (!line.empty()) return line;
  }
  return "it said nothing";
}

// What helps against refusals that Open MPI explains in thirty lines.
std::string advice_for(const std::string& launcher, const std::string& errors) {
  const auto says = [&](const char* text) { return errors.find(text) != std::string::npos; };
  const auto with = [&](const std::string& option) {
    const auto end = std::min(launcher.find(' '), launcher.size());
    return fmt::format("\"{} {}{}\"", launcher.substr(0, end), option, launcher.substr(end));
  };
  if (says("attempt to run as root")) {
    return "it refuses to run as root; run as another user, or where that is meant, say --engine " +
           with("--allow-run-as-root");
  }
  if (says("not enough slots")) {
    return "it has fewer cores than ranks; ask for fewer, or where that is meant, say --engine " +
           with("--oversubscribe");
  }
  return reason_in(errors);
}

void run_ranks(const std::string& launcher, const std::vector<std::string>& task) {
  Launch launch = launch_of(launcher);
  launch.arguments.insert(launch.arguments.end(), task.begin(), task.end());
  int status = 0;
  std::string errors;
  try {
    errors = run_program(launch.program, launch.arguments, status,
                         {.time = kLongest,
                          .memory_bytes = 0,
                          .output_bytes = std::size_t{16} << 20U,
                          .grace = kGrace})
                 .errors;
  } catch (const WorkerDied& died) {
    throw WorkerDied(fmt::format("the engine \"{}\": {}", launcher, died.what()));
  }
  if (status == 0) return;
  const auto what = fmt::format("the engine \"{}\" failed with exit status {}: {}", launcher,
                                status, advice_for(launcher, errors));
  if (status == kOutOfMemory) throw OutOfResources(what + "; use more nodes, or a coarser mesh");
  throw WorkerDied(what);
}

double bound_for(const fem::System& system, const RanksOptions& options, double shift) {
  double hz = options.guess_hz;
  if (options.up_to_hz > 0.0) hz = kBeyond * options.up_to_hz;
  if (!(hz > 0.0)) hz = 0.5 * system.frequency_scale_hz * options.count;
  return hz > 0.0 ? std::pow(kTwoPi * hz, 2) : 100.0 * shift;
}

long long wanted_of(const fem::System& system, const RanksOptions& options) {
  const auto rigid = static_cast<long long>(system.rigid.cols());
  const auto rows = static_cast<long long>(system.mass.rows());
  const long long flexible = options.up_to_hz > 0.0 ? 1 : options.count + kMoreModes;
  return std::min(rows, rigid + flexible);
}

}  // namespace

std::string RanksSummary::line() const {
  const double most =
      peak_bytes.empty() ? 0.0 : *std::max_element(peak_bytes.begin(), peak_bytes.end());
  return fmt::format("{} rank{}: {} shifts, {:.1f} s, up to {:.0f} MB each", peak_bytes.size(),
                     peak_bytes.size() == 1 ? "" : "s", shifts, seconds, 1e-6 * most);
}

RanksResult modes_by_ranks(const fem::System& system, const RanksOptions& options,
                           const Progress& progress) {
  const double shift = fem::inverted_shift(system);
  const Exchange exchange(options.folder);
  const auto& folder = exchange.folder();
  tell(progress, "writing K and M for the ranks");
  const auto index = std::max(io::petsc_index(system.stiffness), io::petsc_index(system.mass));
  io::write_petsc(folder / "stiffness.petsc", system.stiffness, index);
  io::write_petsc(folder / "mass.petsc", system.mass, index);
  tell(progress, "waiting for the ranks");
  run_ranks(options.launcher,
            {folder.string(), fmt::to_string(wanted_of(system, options)), fmt::to_string(shift),
             fmt::to_string(bound_for(system, options, shift))});
  tell(progress, "checking the modes");
  return reply_of(worker_path("chladni-slepc"), [&] {
    auto reply = read_reply(folder, system.mass.rows());
    reply.given.shift = shift;
    const auto flexible = static_cast<int>(reply.given.lambda.size() - system.rigid.cols());
    RanksResult result;
    result.modes = fem::checked_modes(system, reply.given,
                                      {.count = options.up_to_hz > 0.0 ? flexible : options.count});
    result.ranks = {options.launcher, std::move(reply.peak_bytes), reply.shifts, reply.seconds};
    result.modes.summary.factor_seconds = reply.seconds;
    result.modes.summary.text +=
        fmt::format(" by MUMPS on {} rank{}", result.ranks.peak_bytes.size(),
                    result.ranks.peak_bytes.size() == 1 ? "" : "s");
    return result;
  });
}

}  // namespace chladni::cluster
