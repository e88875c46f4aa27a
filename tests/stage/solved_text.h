// The text of a study, solved.
#pragma once

#include <string>
#include <utility>

#include "stage/solution.h"
#include "tests/app/quiet_run.h"

namespace chladni::stage {

struct Solved {
  study::Study study;
  stage::Solution solution;
};

inline Solved solved_with(const std::string& text) {
  const app::TestFolder folder("solved_text");
  study::Study study = study::parse_study(text, "bench/study.toml");
  app::QuietRun quiet(study, folder.path());
  auto solution = stage::solved(study, quiet.run());
  return {std::move(study), std::move(solution)};
}

}  // namespace chladni::stage
