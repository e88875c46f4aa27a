// The verbs of many studies.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "base/progress.h"

namespace chladni::app {

/// What the command line says of a sweep.
struct SweepCommand {
  std::filesystem::path plan, folder;          ///< folder empty: out/<plan's name>
  std::filesystem::path program;               ///< chladni itself
  std::vector<std::filesystem::path> allowed;  ///< --allow-outside
  int threads = 1, jobs = 0;  ///< of a variant; variants at a time, 0: cores / threads
  std::string run;            ///< "3" or "3/10": these variants alone
  bool list = false, scripts = false, retry = false, json = false, pictures = true, cache = true;
  bool reproducible = false;  ///< no wall times in the results
};

/// Runs the variants that have not run, then gathers. Returns the exit code: 4 where one failed, 5
/// where none did but one could not run now.
/// @param said  progress and warnings
[[nodiscard]] int sweep(const SweepCommand& command, std::ostream& results, std::ostream& said,
                        const Progress& progress);
/// Joins what there is.
/// @param said  warnings
[[nodiscard]] int gather(const SweepCommand& command, std::ostream& results, std::ostream& said);

}  // namespace chladni::app
