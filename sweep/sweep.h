// Many studies by one command: each variant of a plan is solved once, in a folder of its own that
// is named by the hash of what it depends on.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "io/json.h"
#include "study/origin.h"
#include "study/sweep_plan.h"
#include "study/sweep_variants.h"

namespace chladni::sweep {

struct SweepOptions {
  std::filesystem::path folder;                ///< of the sweep
  std::filesystem::path program;               ///< chladni
  std::vector<std::filesystem::path> allowed;  ///< --allow-outside of the variants
  int threads = 1;                             ///< of each variant
  bool cache = true;                           ///< variants take what earlier runs have solved
  bool reproducible = false;                   ///< no wall times are left
  std::set<int> passing;  ///< exit codes that say nothing of the variant: no memory, Ctrl-C
};

/// What is left of a variant that has run: its file variant.json.
struct Record {
  int exit = 0;                   ///< exit code of the verb
  std::string error;              ///< last line that it said, where the code is not 0
  std::optional<double> seconds;  ///< none: of a reproducible run
};

/// "open", "done" or "failed".
[[nodiscard]] const char* state(const std::optional<Record>& record);

/// Its wall time; null where there is none.
[[nodiscard]] io::Json json_of_seconds(const std::optional<Record>& record);

/// One variant, and where it stands.
struct Entry {
  long long index = 0;  ///< from 0
  std::vector<std::string> labels;
  std::string text;              ///< its study
  std::string hash;              ///< 16 hexadecimal digits
  std::filesystem::path folder;  ///< of its results
  std::optional<Record> record;  ///< none: it has not run
};

/// How one variant was met.
enum class Outcome {
  found,      ///< it had run before
  ran,        ///< it ran now, well or badly
  elsewhere,  ///< another process runs it
  passing,  ///< it could not run now: its process died or lacked memory, and it is tried next time
};

struct Met {
  Outcome outcome = Outcome::found;
  std::optional<Record> record;  ///< of a variant that has run
  std::string why;               ///< it could not run now
};

class Sweep {
 public:
  /// @throws InvalidInput  too many variants
  Sweep(study::SweepPlan plan, SweepOptions options);
  ~Sweep() = default;
  Sweep(const Sweep&) = delete;
  Sweep& operator=(const Sweep&) = delete;
  Sweep(Sweep&&) = delete;
  Sweep& operator=(Sweep&&) = delete;

  [[nodiscard]] const study::SweepPlan& plan() const { return plan_; }
  [[nodiscard]] long long size() const { return variants_.size(); }
  /// Cost: the base is read.
  /// @throws InvalidInput  the variant is no study
  [[nodiscard]] Entry entry(long long index) const;
  /// Reads every variant. @throws InvalidInput  the first that is no study
  void check() const;
  /// Runs a variant that has not run. Its results appear in its folder whole or not at all.
  /// @param again  also one that failed
  /// @throws OutOfResources  the disk is full
  /// @throws Interrupted     Ctrl-C
  [[nodiscard]] Met run(long long index, bool again = false) const;

 private:
  [[nodiscard]] std::vector<std::string> arguments(const std::filesystem::path& folder) const;
  /// Runs the program in the folder `part`. None if it could not run now; `why` says why.
  [[nodiscard]] std::optional<Record> called(const Entry& entry, const std::filesystem::path& part,
                                             std::string& why) const;
  [[nodiscard]] io::Json json_of(const Entry& entry, const Record& record) const;

  study::SweepPlan plan_;
  SweepOptions options_;
  study::Variants variants_;
  mutable study::Fingerprints fingerprints_;
};

}  // namespace chladni::sweep
