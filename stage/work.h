// What a step of the flow is given beside its data: how to tell of progress, what to warn of, and
// the choices of the one who asked for it.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/progress.h"
#include "host/cache.h"

namespace chladni::stage {

/// Choices of the user that are no part of a study.
struct WorkOptions {
  unsigned seed = 1;        ///< of all random numbers
  bool certificate = true;  ///< count the modes by inertia
  bool keep_best = false;   ///< an interrupt ends a fit with the best one so far
  bool keep_times = true;   ///< of the steps; without them results are the same to the last bit
  std::string engine;       ///< what starts the ranks that find the modes; empty: the study's
  /// For a solution in this process, and for recordings that are read; 0: what there is.
  std::size_t memory_limit_bytes = 0;
  std::vector<std::filesystem::path>
      allowed;                         ///< folders outside the study's from which it may read
  std::filesystem::path folder;        ///< where the results will stand
  std::shared_ptr<const Cache> cache;  ///< of meshes and modes; null: all is solved here
};

/// The base class tells nobody anything: enough for callers from C++ that only want results. The
/// command line tells its user, and writes the times into the results.
class Work {
 public:
  explicit Work(WorkOptions options = {}) : options_(std::move(options)) {}
  virtual ~Work() = default;
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;
  Work(Work&&) = delete;
  Work& operator=(Work&&) = delete;

  /// Tells something that is good to know.
  virtual void note(std::string_view line);
  /// The same, but a line that was told before is not told again.
  void note_once(const std::string& line);
  /// Tells something that the user should act on.
  virtual void warn(std::string_view message);
  /// Shows a part of the result.
  virtual void show(std::string_view text);
  /// For a long step: empty where nobody looks.
  [[nodiscard]] virtual Progress progress() { return {}; }
  /// Ends the progress line before other text.
  virtual void clear_progress() {}

  [[nodiscard]] const WorkOptions& choices() const { return options_; }
  [[nodiscard]] unsigned seed() const { return options_.seed; }

  /// Runs one step and stores its wall time, together with that of its earlier runs.
  template <typename Step>
  auto timed(const std::string& name, Step step) {
    const auto start = std::chrono::steady_clock::now();
    auto result = step();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    if (options_.keep_times) store(part_ + name, took.count());
    return result;
  }
  /// Wall time of each finished step [s], each name once.
  [[nodiscard]] const std::vector<std::pair<std::string, double>>& seconds() const {
    return seconds_;
  }

  /// While it exists, steps and shown text have the name of a part of the work: "truth: mesh".
  class Part {
   public:
    Part(Work& work, std::string name) : work_(work) { work_.part_ = std::move(name); }
    ~Part() { work_.part_.clear(); }
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;

   private:
    Work& work_;
  };
  [[nodiscard]] Part part(std::string name) { return {*this, std::move(name)}; }
  [[nodiscard]] const std::string& part() const { return part_; }

 private:
  void store(const std::string& name, double seconds);

  WorkOptions options_;
  std::vector<std::pair<std::string, double>> seconds_;
  std::string part_;
  std::set<std::string> told_once_;
};

}  // namespace chladni::stage
