// Common parts of all verbs of the command line.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/output_folder.h"
#include "app/study/origin.h"
#include "app/study/study.h"
#include "app/terminal.h"
#include "io/json.h"

namespace chladni::app {

/// Options of the command line, in addition to the verb and the study.
struct Options {
  std::filesystem::path folder;                ///< -o; empty: out/<study name>
  std::vector<std::filesystem::path> allowed;  ///< --allow-outside
  int threads = 0;                             ///< 0: number of physical cores
  long long seed = -1;                         ///< −1: that of the study, or 1
  bool quiet = false, json = false;
  bool certificate = true;  ///< the inertia count
  bool pictures = true;
  int animate = 0;             ///< mode, counted from 1, for the phase animation
  bool expect = false;         ///< `check` computes the modes and compares
  bool reproducible = false;   ///< no times in the results
  bool keep_best = false;      ///< Ctrl-C stops a fit, not the program
  std::string unit;            ///< for `check` of measured data without a unit
  double sample_time_s = 0.0;  ///< likewise
};

/// One run of a verb: its output folder, its messages, and the times of its steps.
class Run {
 public:
  /// @throws as OutputFolder
  Run(const Study& study, Options options, std::ostream& results, Talk& talk);
  /// Reports results in the folder that belong to another state of the study than those of this
  /// run. A report of another state is kept as report_before.html.
  ~Run();
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;
  Run(Run&&) = delete;
  Run& operator=(Run&&) = delete;

  [[nodiscard]] const Options& options() const { return options_; }
  [[nodiscard]] unsigned seed() const { return seed_; }
  [[nodiscard]] std::filesystem::path operator/(std::string_view name) const;
  [[nodiscard]] Talk& talk() { return talk_; }
  /// Wall time of each finished step; empty with --reproducible.
  [[nodiscard]] std::vector<std::pair<std::string, double>> seconds() const;

  /// Text for the user, on stdout; nothing with --json.
  void show(std::string_view text);
  /// Runs one step and stores its wall time for the results.
  template <typename Step>
  auto timed(const std::string& name, Step step) {
    const auto start = std::chrono::steady_clock::now();
    const auto keep = [&] {
      const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
      seconds_.emplace_back(part_ + name, took.count());
    };
    auto result = step();
    keep();
    return result;
  }
  /// While it exists, steps and shown text have the name of a part of the run: "truth: mesh".
  class Part {
   public:
    Part(Run& run, std::string name) : run_(run) { run_.part_ = std::move(name); }
    ~Part() { run_.part_.clear(); }
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;

   private:
    Run& run_;
  };
  [[nodiscard]] Part part(std::string name) { return {*this, std::move(name)}; }
  /// Writes `content` as a JSON file with the common header (version, study, seed, seconds).
  /// `--json` prints only the verb's own `main_result`.
  void leave(const std::string& file, io::JsonObject content, bool main_result);

  /// Lets `draw` paint the picture `file`, unless pictures are switched off. A failure is a
  /// warning, and an older picture of that name is removed.
  void paint(const std::string& file,
             const std::function<void(const std::filesystem::path& png)>& draw);
  /// True if this run painted it.
  [[nodiscard]] bool has_painted(const std::string& file) const { return painted_.contains(file); }
  /// The fingerprints in the results of this run: of the study, of the body's file and, with
  /// `measured`, of the measurement's files. Each file is read once.
  [[nodiscard]] Origin origin(bool measured);

 private:
  void put_outdated_aside();

  const Study& study_;
  Options options_;
  std::ostream& results_;
  Talk& talk_;
  OutputFolder folder_;
  unsigned seed_;
  std::vector<std::pair<std::string, double>> seconds_;
  std::string part_;
  std::map<std::filesystem::path, std::string> fingerprint_;
  std::set<std::string> painted_;
  std::string last_fault_;  // of a picture
  bool has_left_ = false;
};

struct Command {
  std::string_view name;     ///< the word typed
  std::string_view summary;  ///< one line for --help
  void (*run)(const Study& study, Run& run);
};

extern const Command check_command;
extern const Command mesh_command;
extern const Command modes_command;
extern const Command place_command;
extern const Command priors_command;
extern const Command simulate_command;
extern const Command identify_command;
extern const Command interpolate_command;
extern const Command diagnose_command;
extern const Command study_command;

/// Verbs without a study. They return the exit code.
[[nodiscard]] int doctor(std::ostream& results);
[[nodiscard]] int list(std::string_view what, std::ostream& results);
[[nodiscard]] std::vector<std::string> listable();
[[nodiscard]] int convert(const std::filesystem::path& from, const std::filesystem::path& to,
                          const std::string& unit, std::ostream& results);
/// Measured data: the content of a file and suspect values; conversion between formats.
[[nodiscard]] int check_data(const std::filesystem::path& file, const Options& options,
                             std::ostream& results);
[[nodiscard]] int convert_data(const std::filesystem::path& from, const std::filesystem::path& to,
                               const std::string& unit, std::ostream& results);

}  // namespace chladni::app
