// chladni sweep PLAN, chladni gather PLAN: many studies by one command.
#include "app/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <filesystem>
#include <mutex>
#include <ostream>
#include <vector>

#include "app/command_line/exit_code.h"
#include "base/error.h"
#include "host/atomic_file.h"
#include "host/parallel.h"
#include "host/shell_word.h"
#include "study/sweep_plan.h"
#include "sweep/gathered.h"
#include "sweep/scripts.h"
#include "sweep/sweep.h"

namespace chladni::app {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const SweepCommand& command) {
  return command.folder.empty() ? fs::path("out") / command.plan.stem() : command.folder;
}

sweep::SweepOptions options_of(const SweepCommand& command) {
  return {.folder = folder_of(command),
          .program = command.program,
          .allowed = command.allowed,
          .threads = command.threads,
          .cache = command.cache,
          .reproducible = command.reproducible,
          .passing = {kOutOfResources, kWorkerDied, kInterrupted}};
}

int whole_number(std::string_view text, const std::string& all) {
  int value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  require(fault == std::errc() && end == text.data() + text.size() && value >= 1,
          "--run is \"" + all +
              "\", expected a variant such as 3, or 3/10 for every tenth from the "
              "third on");
  return value;
}

// The variants that are meant, counted from 0.
std::vector<long long> wanted(const SweepCommand& command, long long size) {
  long long first = 1;
  long long step = 1;
  if (!command.run.empty()) {
    const auto slash = command.run.find('/');
    first = whole_number(std::string_view(command.run).substr(0, slash), command.run);
    step = slash == std::string::npos
               ? size
               : whole_number(std::string_view(command.run).substr(slash + 1), command.run);
    require(first <= size,
            fmt::format("--run is {}, but there are {} variants", command.run, size));
  }
  std::vector<long long> list;
  for (auto i = first - 1; i < size; i += step) list.push_back(i);
  return list;
}

void show_list(const sweep::Sweep& sweep, const std::vector<long long>& list,
               std::ostream& results) {
  for (const auto i : list) {
    const auto entry = sweep.entry(i);
    results << fmt::format("{:>6} {} {:<6} {}\n", i + 1, entry.hash, sweep::state(entry.record),
                           fmt::join(entry.labels, ", "));
  }
}

// The options of this call that belong to each call of a script.
std::vector<std::string> flags_of(const SweepCommand& command) {
  std::vector<std::string> flags;
  if (command.retry) flags.emplace_back("--retry");
  if (!command.cache) flags.emplace_back("--no-cache");
  if (command.reproducible) flags.emplace_back("--reproducible");
  return flags;
}

void leave_scripts(const SweepCommand& command, const sweep::Sweep& sweep, std::ostream& results) {
  const auto folder = folder_of(command);
  fs::create_directories(folder);
  const sweep::ScriptPlan plan{.name = sweep.plan().name,
                               .program = command.program,
                               .plan = command.plan,
                               .folder = folder,
                               .allowed = command.allowed,
                               .variants = sweep.size(),
                               .threads = command.threads,
                               .flags = flags_of(command)};
  const auto sbatch = (folder / "sweep.sbatch").string();
  const auto make = (folder / "sweep.mk").string();
  write_atomically(sbatch, sweep::slurm_script(plan));
  write_atomically(make, sweep::makefile(plan));
  if (command.json) {
    results << io::text(
        io::JsonObject{{"variants", sweep.size()}, {"sbatch", sbatch}, {"makefile", make}});
    return;
  }
  results << fmt::format("{} variants\nsbatch {}\nmake -k -j 8 -f {}\nchladni gather {} -o {}\n",
                         sweep.size(), shell_word(sbatch), shell_word(make),
                         shell_word(command.plan.string()), shell_word(folder.string()));
}

struct Tally {
  std::atomic<long long> ended = 0, failed = 0, passing = 0, elsewhere = 0;

  [[nodiscard]] int exit_code() const {
    if (failed > 0) return kNumericalFailure;
    return passing > 0 ? kOutOfResources : kDone;
  }
};

// Another number of threads for the loops of this scope.
class ThreadCount {
 public:
  explicit ThreadCount(int count) : before_(thread_count()) { set_thread_count(count); }
  ~ThreadCount() { set_thread_count(before_); }
  ThreadCount(const ThreadCount&) = delete;
  ThreadCount& operator=(const ThreadCount&) = delete;
  ThreadCount(ThreadCount&&) = delete;
  ThreadCount& operator=(ThreadCount&&) = delete;

 private:
  int before_;
};

// Runs the variants, several at a time; each is a process of its own. No further one begins where
// `progress` has thrown.
void run_all(const SweepCommand& command, const sweep::Sweep& sweep,
             const std::vector<long long>& list, Tally& tally, std::ostream& said,
             const Progress& progress) {
  const ThreadCount count(
      std::max(1, command.jobs > 0 ? command.jobs : thread_count() / command.threads));
  std::atomic<bool> stopped = false;
  std::mutex speaking;
  const auto tell_failure = [&](long long index, const std::string& what) {
    const std::scoped_lock lock(speaking);
    said << fmt::format("variant {}: {}\n", index + 1, what);
  };
  const auto tell_ended = [&] {
    const std::scoped_lock lock(speaking);  // counted and told at once: the last told is the whole
    ++tally.ended;
    try {
      tell(progress, "sweeping",
           static_cast<double>(tally.ended) / static_cast<double>(list.size()));
    } catch (...) {
      stopped = true;
      throw;
    }
  };
  parallel_tasks(list.size(), [&](std::size_t i) {
    if (stopped) return;
    const auto met = sweep.run(list[i], command.retry);
    if (met.outcome == sweep::Outcome::elsewhere) ++tally.elsewhere;
    if (met.outcome == sweep::Outcome::passing) {
      ++tally.passing;
      tell_failure(list[i], met.why + "; it is tried again next time");
    } else if (met.record && met.record->exit != 0) {
      ++tally.failed;
      if (met.outcome == sweep::Outcome::ran) tell_failure(list[i], met.record->error);
    }
    tell_ended();
  });
}

void leave_gathered(const SweepCommand& command, const sweep::Sweep& sweep, std::ostream& results,
                    std::ostream& said) {
  const auto all = sweep::gathered(sweep);
  for (const auto& picture : sweep::leave(sweep, all, folder_of(command), command.pictures)) {
    said << "warning: " << picture << "; everything else is there\n";
  }
  if (command.json) {
    results << io::text(sweep::json(sweep, all));
  } else {
    results << sweep::text(sweep, all)
            << fmt::format("\n{}\n", (folder_of(command) / "table.csv").string());
  }
}

}  // namespace

int sweep(const SweepCommand& command, std::ostream& results, std::ostream& said,
          const Progress& progress) {
  require(command.threads >= 1, "a variant needs one thread or more");
  require(command.jobs >= 0, "the number of variants at a time is negative; expected 1 or more");
  const sweep::Sweep sweep(study::read_sweep(command.plan, !command.list), options_of(command));
  const auto list = wanted(command, sweep.size());
  if (command.list) {
    if (command.json) {
      results << io::text(sweep::json(sweep, list));
    } else {
      show_list(sweep, list, results);
    }
    return 0;
  }
  if (command.run.empty()) sweep.check();  // before the first one is solved
  if (command.scripts) {
    leave_scripts(command, sweep, results);
    return 0;
  }
  Tally tally;
  run_all(command, sweep, list, tally, said, progress);
  if (tally.elsewhere > 0) {
    said << fmt::format("{} variants are run by another sweep; gather again when it has ended\n",
                        tally.elsewhere.load());
  }
  if (!command.run.empty()) {
    if (command.json) results << io::text(sweep::json(sweep, list));
    return tally.exit_code();
  }
  leave_gathered(command, sweep, results, said);
  return tally.exit_code();
}

int gather(const SweepCommand& command, std::ostream& results, std::ostream& said) {
  leave_gathered(command, {study::read_sweep(command.plan), options_of(command)}, results, said);
  return kDone;
}

}  // namespace chladni::app
