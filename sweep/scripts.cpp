#include "sweep/scripts.h"

#include <fmt/format.h>

#include <algorithm>

#include "host/shell_word.h"

namespace chladni::sweep {
namespace {

// A word of the shell, whatever is in it.
std::string quoted(const std::filesystem::path& path) {
  return shell_quoted(std::filesystem::absolute(path).lexically_normal().string());
}

std::string command(const ScriptPlan& plan, const std::string& share) {
  std::string text = fmt::format("{} sweep {} -o {} --run {} --threads {}", quoted(plan.program),
                                 quoted(plan.plan), quoted(plan.folder), share, plan.threads);
  for (const auto& flag : plan.flags) text += " " + flag;
  for (const auto& folder : plan.allowed) text += " --allow-outside " + quoted(folder);
  return text;
}

long long tasks_of(const ScriptPlan& plan) { return std::min(plan.variants, kMostTasks); }

// A name that sbatch takes.
std::string plain(std::string name) {
  std::replace_if(
      name.begin(), name.end(),
      [](unsigned char c) { return std::isalnum(c) == 0 && c != '-' && c != '_'; }, '_');
  return name;
}

}  // namespace

std::string slurm_script(const ScriptPlan& plan) {
  const auto tasks = tasks_of(plan);
  return fmt::format(
      "#!/bin/bash\n"
      "# {} variants of a sweep. Submit it with: sbatch sweep.sbatch\n"
      "# What is done is never done again: submit it again after tasks were killed.\n"
      "# What failed runs again only with --retry.\n"
      "#SBATCH --job-name={}\n"
      "#SBATCH --array=1-{}\n"
      "#SBATCH --cpus-per-task={}\n"
      "#SBATCH --output=slurm-%A_%a.log\n"
      "exec {}\n",
      plan.variants, plain(plan.name), tasks, plan.threads,
      command(plan, fmt::format("\"${{SLURM_ARRAY_TASK_ID}}/{}\"", tasks)));
}

std::string makefile(const ScriptPlan& plan) {
  const auto tasks = tasks_of(plan);
  // make's own dollar signs are doubled.
  std::string line;
  for (const char c : command(plan, fmt::format("@/{}", tasks))) {
    line += c == '$' ? std::string("$$") : std::string(1, c);
  }
  const auto at = line.find("@/");
  line.replace(at, 1, "$(@:task-%=%)");
  std::string targets;
  for (long long i = 1; i <= tasks; ++i) targets += fmt::format(" task-{}", i);
  return fmt::format(
      "# {} variants of a sweep: make -k -j 8 -f sweep.mk\n"
      "TASKS ={}\n"
      ".PHONY: all $(TASKS)\n"
      "all: $(TASKS)\n"
      "$(TASKS):\n"
      "\t{}\n",
      plan.variants, targets, line);
}

}  // namespace chladni::sweep
