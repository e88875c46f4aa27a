// The text of a study, solved.
#pragma once

#include <string>
#include <utility>

#include "quiet_run.h"
#include "stage/solution.h"

namespace chladni::app {

struct Solved {
  study::Study study;
  stage::Solution solution;
};

inline Solved solved_with(const std::string& text) {
  const TestFolder folder("solved_text");
  study::Study study = study::parse_study(text, "bench/study.toml");
  QuietRun quiet(study, folder.path());
  auto solution = stage::solved(study, quiet.run());
  return {std::move(study), std::move(solution)};
}

}  // namespace chladni::app
