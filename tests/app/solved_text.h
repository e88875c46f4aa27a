// The text of a study, solved.
#pragma once

#include <string>
#include <utility>

#include "quiet_run.h"
#include "stage/solution.h"

namespace chladni::app {

struct Solved {
  Study study;
  Solution solution;
};

inline Solved solved_with(const std::string& text) {
  const TestFolder folder("solved_text");
  Study study = parse_study(text, "bench/study.toml");
  QuietRun quiet(study, folder.path());
  auto solution = solved(study, quiet.run());
  return {std::move(study), std::move(solution)};
}

}  // namespace chladni::app
