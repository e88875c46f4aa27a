// The work of a step that Python asked for.
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "python/calls/long_call.h"
#include "python/opened_study.h"
#include "python/values/seed.h"
#include "stage/work.h"

namespace chladni::python {

/// What a step said beside its result.
struct Said {
  std::vector<std::string> notes, warnings;
  std::vector<std::pair<std::string, double>> seconds;  ///< wall time of each part of the step
  unsigned seed = 1;                                    ///< of the step
};

/// What a function of Python gives to a step beside the study.
struct Asked {
  pybind11::object progress;  ///< None, False, or a function of a text and a number
  std::optional<Seed> seed;   ///< none: that of the study, or 1
  bool certificate = true;
  std::string engine;
  double memory_limit_gb = 0.0;
};

/// Keeps notes and warnings, and tells a function of Python of the progress: when a part begins,
/// and at most ten times a second within it. Make and destroy it with the interpreter's lock.
class PythonWork : public stage::Work {
 public:
  PythonWork(const Subject& subject, const Asked& asked);
  explicit PythonWork(const Asked& asked);  ///< without a study
  ~PythonWork() override;
  PythonWork(const PythonWork&) = delete;
  PythonWork& operator=(const PythonWork&) = delete;
  PythonWork(PythonWork&&) = delete;
  PythonWork& operator=(PythonWork&&) = delete;

  void note(std::string_view line) override { said_.notes.emplace_back(line); }
  void warn(std::string_view message) override { said_.warnings.emplace_back(message); }
  [[nodiscard]] Progress progress() override;

  /// Calls step(), without the interpreter's lock, and gives its result.
  /// @throws as `step`, or what the function of Python raised
  template <typename Step>
  auto done(Step step) {
    try {
      const LongCall call;
      return step();
    } catch (const Interrupted&) {
      if (raised_) throw std::move(*raised_);
      throw;
    }
  }

  /// Everything said so far. The warnings are those of Python as well.
  [[nodiscard]] Said said();

 private:
  void hear(std::string_view step, double fraction);

  pybind11::object heard_;  // by whom; None
  std::optional<pybind11::error_already_set> raised_;
  std::string last_step_;
  std::chrono::steady_clock::time_point last_time_;
  Said said_;
};

/// Issues each as a chladni.ChladniWarning. @throws what a filter of Python makes of it
void warn_python(const std::vector<std::string>& warnings);

}  // namespace chladni::python
