// A study as Python holds it, and what the steps of the flow take in its place.
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <memory>
#include <vector>

#include "stage/solution.h"
#include "study/study.h"

namespace chladni::python {

struct OpenedStudy {
  study::Study study;
  std::vector<std::filesystem::path> allowed;  ///< folders outside its own that it may read
};

/// What a step works on: a study, with its modes where they were computed before.
struct Subject {
  std::shared_ptr<const OpenedStudy> opened;
  std::shared_ptr<const stage::Solution> solution;  ///< null: not solved yet

  [[nodiscard]] const study::Study& study() const { return opened->study; }
};

/// From a Study, the modes of one, or what makes a Study: a path or a dict.
/// @throws InvalidInput  as study::read_study
[[nodiscard]] Subject subject_of(const pybind11::object& given);

/// The study with another [state_space], where a number is above 0.
/// @throws InvalidInput  a number below 0, or not finite
[[nodiscard]] study::Study with_state_space(study::Study study, double sample_rate_hz, int states,
                                            int pade_order);

}  // namespace chladni::python
