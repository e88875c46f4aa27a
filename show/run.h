// A run of a verb: what the user asked for, and where its results and messages go.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "io/json.h"
#include "io/picture_file.h"
#include "show/run/output_folder.h"
#include "show/run/terminal.h"
#include "stage/work.h"
#include "study/origin.h"
#include "study/study.h"

namespace chladni::show {

/// Options of the command line, in addition to the verb and the study.
struct Options {
  std::filesystem::path folder;                ///< -o; empty: out/<study name>
  std::vector<std::filesystem::path> allowed;  ///< --allow-outside
  std::string engine;                          ///< --engine; empty: the study's
  double memory_limit_gb = 0.0;                ///< 0: what there is
  int threads = 0;                             ///< 0: number of physical cores
  long long seed = -1;                         ///< −1: that of the study, or 1
  bool quiet = false, json = false;
  bool all = false;         ///< every table on the terminal, not only what matters first
  bool certificate = true;  ///< the inertia count
  bool pictures = true;
  bool vectors = false;        ///< plots also as SVG
  int animate = 0;             ///< mode, counted from 1, for the phase animation
  bool expect = false;         ///< `check` computes the modes and compares
  bool reproducible = false;   ///< no times in the results
  bool keep_best = false;      ///< Ctrl-C stops a fit, not the program
  bool watch = false;          ///< run again at each change of a file that is read
  bool cache = true;           ///< take meshes and modes of earlier runs, and keep those of this
  std::string unit;            ///< for `check` of measured data without a unit
  double sample_time_s = 0.0;  ///< likewise
};

/// One run of a verb: its output folder, its messages, and the times of its steps.
class Run : public stage::Work {
 public:
  /// @throws as OutputFolder
  Run(const study::Study& study, Options options, std::ostream& results, Talk& talk);
  /// Reports results in the folder that belong to another state of the study than those of this
  /// run. A report of another state is kept as report_before.html; so are pictures and fields of
  /// another state whose result was replaced while they were not.
  ~Run() override;
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;
  Run(Run&&) = delete;
  Run& operator=(Run&&) = delete;

  [[nodiscard]] const Options& options() const { return options_; }
  [[nodiscard]] std::filesystem::path operator/(std::string_view name) const;
  void note(std::string_view line) override { talk_.note(line); }
  void warn(std::string_view message) override { talk_.warn(message); }
  [[nodiscard]] Progress progress() override { return talk_.progress(); }
  void clear_progress() override { talk_.clear_progress(); }
  /// Text for the user, on stdout; nothing with --json.
  void show(std::string_view text) override;
  /// Writes `content` as a JSON file with the common header (version, study, seed, seconds).
  /// `--json` prints only the verb's own `main_result`.
  void leave(const std::string& file, io::JsonObject content, bool main_result);

  /// Renames what stands as `file`, where this run could have left it and did not: it would be
  /// taken for a result of this run. `a.toml` becomes `a_before.toml`, and a warning says so. What
  /// the study itself is read from stays.
  void put_aside(const std::string& file);

  /// Lets `draw` paint the picture `file`, unless pictures are switched off. The program goes on
  /// meanwhile. Input that cannot be drawn and a painter's failure are warnings: all other results
  /// are there. An older picture of that name is removed where the painter fails.
  void paint(const std::string& file, const std::function<void(const io::PictureFile& png)>& draw);
  /// Waits until all pictures are there.
  /// @throws what prevented one, but for a failure of the painter
  void finish_pictures();
  /// True if this run painted it, once finish_pictures() has returned.
  [[nodiscard]] bool has_painted(const std::string& file) const { return painted_.contains(file); }
  /// The fingerprints in the results of this run: of the study, of the body's file and, with
  /// `measured`, of the measurement's files. Each file is read once.
  [[nodiscard]] study::Origin origin(bool measured);

 private:
  void put_outdated_aside(const std::vector<std::string>& outdated);
  void put_companions_aside(const std::vector<std::string>& outdated);
  [[nodiscard]] bool is_read(const std::filesystem::path& file) const;
  void warn_not_painted(const std::string& file, const std::string& why);

  const study::Study& study_;
  Options options_;
  std::ostream& results_;
  Talk& talk_;
  OutputFolder folder_;
  study::Fingerprints fingerprints_;
  io::PaintQueue pictures_;
  std::set<std::string> painted_;
  std::set<std::string> replaced_;  // results of another state, which this run has overwritten
  std::string last_fault_;          // of a picture
  bool has_left_ = false;
};

}  // namespace chladni::show
