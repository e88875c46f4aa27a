// Scripts that run a sweep elsewhere: a SLURM job array and a Makefile.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace chladni::sweep {

struct ScriptPlan {
  std::string name;  ///< of the job
  std::filesystem::path program, plan, folder;
  std::vector<std::filesystem::path> allowed;
  long long variants = 0;
  int threads = 1;
  std::vector<std::string> flags = {};  ///< further options of each call: --retry
};

/// Most tasks of a job array: SLURM's MaxArraySize is 1001 where nobody changed it.
inline constexpr long long kMostTasks = 1000;

/// For `sbatch`: one task per variant, or kMostTasks tasks that take turns.
[[nodiscard]] std::string slurm_script(const ScriptPlan& plan);
/// For `make -j N`: one target per variant. A variant that fails does not stop the others.
[[nodiscard]] std::string makefile(const ScriptPlan& plan);

}  // namespace chladni::sweep
