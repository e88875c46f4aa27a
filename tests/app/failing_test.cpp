// Whatever call to the system fails: a verb ends with a sentence and its exit code, and what it
// leaves is whole. Which calls fail is drawn by the commit (tests/rotation).
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>
#include <optional>
#include <random>
#include <regex>
#include <set>
#include <sstream>

#include "rotation/drawn_sample.h"
#include "rotation/turn.h"
#include "tests/app/program.h"

namespace chladni::app {
namespace {

/// A verb as it is called in the test's folder. Its results go to "out".
struct Verb {
  std::string name;
  std::vector<std::string> words;
  bool is_slow = false;  ///< half as many of its calls fail
};

void PrintTo(const Verb& verb, std::ostream* stream) { *stream << verb.name; }

/// A call that fails, and the kinds of them in the order of failing_calls.cpp.
struct Failure {
  std::string kind;
  long at = 0;
  int error = 0;
  bool on = false;  ///< and all later ones

  [[nodiscard]] std::string text() const {
    return fmt::format("CHLADNI_FAIL_CALL={} CHLADNI_FAIL_AT={} CHLADNI_FAIL_ERROR={}{}", kind, at,
                       error, on ? " CHLADNI_FAIL_ON=1" : "");
  }
};
const std::vector<std::string> kKinds = {"allocate", "write", "read",  "open",
                                         "sync",     "close", "rename"};

struct Answer {
  Ended ended;
  std::map<std::string, std::string> files;  ///< below "out", by name
};

// A cantilever with a patch of every table that a verb asks for.
constexpr const char* kStage = R"(title = "small cantilever"
geometry = { plate = { length = "100 mm", width = "60 mm", thickness = "5 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
support = [{ patch = "x_min", fixed = "xyz" }]
mesh = { edge_length = "20 mm", order = 2 }
modes = { count = 6, damping_ratio = 0.01 }
sensor = [{ name = "s1", at = ["45 mm", "25 mm"], direction = "z" },
          { name = "s2", at = ["30 mm", "-15 mm"], direction = "z" },
          { name = "s3", at = ["20 mm", "26 mm"], direction = "z" }]
actuator = [{ name = "a1", at = ["45 mm", "25 mm"], direction = "z" }]
placement = { modes = 3 }
priors = { modes = 2 }
design = { force = "5 N" }
identification = { modes = 3 }
[experiment]
sample_rate = "40 kHz"
samples = 1024
band = ["200 Hz", "16 kHz"]
noise_ratio = 0.002
[measurement]
)";

constexpr const char* kSweep = R"(base = "study.toml"
verb = "modes"
axis = [{ key = "geometry.plate.thickness", values = ["5 mm", "6 mm"] }]
result = [{ name = "first", file = "modes.json", at = "frequency_hz.1" }]
)";

// A point that no sensor sees, for the observer.
constexpr const char* kObserver = R"([observer]
noise = "2 nm"
point = [{ name = "tip", at = ["48 mm", "0 mm"], direction = "z" }]
disturbance = [{ name = "amplifier", kind = "actuators", rms = "0.1 N" }]
)";

constexpr const char* kModes = R"(frequency_hz,damping_ratio
432.6,0.01
1560.0,0.01
2690.0,0.01
)";

// The verb of a study, and its options that make results comparable.
Verb of_study(const std::string& verb, const std::string& study = "study.toml") {
  std::vector<std::string> words{verb, study, "-o", "out", "--reproducible", "--threads", "1"};
  if (verb != "check") words.emplace_back("--no-pictures");
  return {.name = verb, .words = words};
}

Verb with_pictures() {
  Verb verb = of_study("mesh");
  verb.words.pop_back();
  verb.name = "pictures";
  verb.is_slow = true;
  return verb;
}

std::vector<Verb> all_verbs() {
  std::vector<Verb> verbs;
  for (const auto* verb : {"check", "mesh", "modes", "export", "place", "priors", "experiment",
                           "identify", "interpolate", "compare", "study"}) {
    verbs.push_back(of_study(verb));
  }
  verbs.push_back(of_study("simulate", "rig.toml"));
  verbs.push_back(of_study("observe", "observer.toml"));
  verbs.push_back(of_study("diagnose", "modes.toml"));
  verbs.back().is_slow = true;
  verbs.push_back(with_pictures());
  verbs.push_back({"data", {"check", "rig.csv"}});
  verbs.push_back({"convert", {"convert", "rig.csv", "out/rig.mat"}});
  verbs.push_back({"new", {"new", "plate", "-o", "out/new.toml"}});
  verbs.push_back({"list", {"list", "keys"}});
  verbs.push_back({"cache", {"cache"}});
  verbs.push_back({"help", {"--help"}});
  verbs.push_back({"gather", {"gather", "plan.toml", "-o", "out", "--no-pictures"}});
  verbs.push_back(of_study("mesh", "filled.toml"));
  verbs.back().name = "fill";
  verbs.push_back(of_study("modes", "wrong.toml"));
  verbs.back().name = "error";
  verbs.push_back(of_study("modes"));
  verbs.back().name = "json";
  verbs.back().words.emplace_back("--json");
  return verbs;
}

const rotation::DrawnSample& sample() {
  static const auto drawn = [] {
    const char* asked = std::getenv("CHLADNI_STUDIES");
    return rotation::drawn_sample(asked == nullptr ? "" : asked,
                                  rotation::tree_state(CHLADNI_SOURCE_DIR));
  }();
  return drawn;
}

// By the commit, so that each one tries others; a number in CHLADNI_STUDIES repeats them.
unsigned long seed() {
  const auto commit = rotation::tree_state(CHLADNI_SOURCE_DIR).commit;
  const char* asked = std::getenv("CHLADNI_STUDIES");
  if (asked != nullptr && *asked != '\0') return sample().number;
  return commit.size() < 8 ? 1 : std::stoul(commit.substr(0, 6), nullptr, 16);
}

class FailingCalls : public CommandLine {
 protected:
  void SetUp() override {
    CommandLine::SetUp();
    write("study.toml", std::string(kStage) + "frf = \"rig.csv\"\n");
    write("rig.toml", std::string(kStage) + "frf = \"out/rig.csv\"\n");
    write("observer.toml", std::string(kStage) + "frf = \"rig.csv\"\n" + kObserver);
    write("modes.toml", std::string(kStage) + "modes = \"modes.csv\"\n");
    write("modes.csv", kModes);
    write("plan.toml", kSweep);
    std::string filled = kStage;
    filled.replace(filled.find("order = 2"), 9, "order = 2, mesher = \"tetgen\"");
    write("filled.toml", filled);
    std::string wrong = kStage;
    wrong.replace(wrong.find("thickness ="), 9, "thicknes");
    write("wrong.toml", wrong);
  }

  // Writes rig.csv, which most verbs read.
  void measure() const {
    const auto rig = ended(started({"simulate", "study.toml", "-o", "rig", "--no-pictures"}, "",
                                   [&] { setenv("CHLADNI_CACHE", "off", 1); }));
    ASSERT_EQ(rig.status, 0) << rig.err;
  }

  struct Manner {
    std::optional<Failure> failure{};
    bool cached = false, is_short = false, counts = false;
    bool keeps = false;  ///< what an earlier run left in "out"
  };
  [[nodiscard]] Answer answer(const Verb& verb, const Manner& manner) const {
    if (!manner.keeps) fs::remove_all(folder_ / "out");
    fs::create_directories(folder_ / "out");
    const auto child = started(verb.words, "", [&] {
      dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
      setenv("LD_PRELOAD", CHLADNI_FAILING_CALLS, 1);
      setenv("OPENBLAS_NUM_THREADS", "1", 1);
      setenv("CHLADNI_CACHE", manner.cached ? (folder_ / "kept").c_str() : "off", 1);
      if (manner.counts) setenv("CHLADNI_FAIL_COUNT", (folder_ / "counts").c_str(), 1);
      if (manner.is_short) setenv("CHLADNI_FAIL_SHORT", "1", 1);
      if (!manner.failure) return;
      setenv("CHLADNI_FAIL_CALL", manner.failure->kind.c_str(), 1);
      setenv("CHLADNI_FAIL_AT", std::to_string(manner.failure->at).c_str(), 1);
      setenv("CHLADNI_FAIL_ERROR", std::to_string(manner.failure->error).c_str(), 1);
      if (manner.failure->on) setenv("CHLADNI_FAIL_ON", "1", 1);
    });
    Answer all{ended(child), {}};
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / "out")) {
      if (!entry.is_regular_file()) continue;
      all.files[entry.path().lexically_relative(folder_ / "out")] = whole(entry.path());
    }
    return all;
  }

  /// Calls of each kind in the last run that counted.
  [[nodiscard]] std::map<std::string, long> counts() const {
    std::map<std::string, long> counts;
    std::istringstream numbers(whole(folder_ / "counts"));
    for (const auto& kind : kKinds) numbers >> counts[kind];
    return counts;
  }
};

class Failing : public FailingCalls, public testing::WithParamInterface<Verb> {};

class FailingSweep : public FailingCalls {
 protected:
  static std::vector<std::string> words() {
    return {"sweep", "plan.toml", "-o", "out", "--no-pictures", "--jobs", "1"};
  }
  // A sweep tells how long each variant took.
  static std::map<std::string, std::string> without_times(
      std::map<std::string, std::string> files) {
    const std::regex times(
        R"re("(seconds|geometry|mesh|places|assembly|modes|error_estimate)": [0-9][^,\n]*)re");
    for (auto& [name, bytes] : files) {
      if (name.ends_with(".json")) bytes = std::regex_replace(bytes, times, "\"$1\": 0");
    }
    return files;
  }
};

// What breaks the law; empty where nothing does.
std::string fault(const Answer& sound, const Answer& met, const Failure& failure) {
  const auto& [status, out, err] = met.ended;
  const std::set<int> allowed{0, 5, sound.ended.status};
  if (!allowed.contains(status)) return fmt::format("exit {}", status);
  // The write that fails may be that of the sentence.
  const bool mute = failure.kind == "write" && (failure.on || sound.ended.status != 0);
  if (status != 0 && !mute && err.find("error: ") == std::string::npos) return "no sentence";
  if (err.find("fault of Chladni") != std::string::npos) return "unforeseen";
  // A worker whose reply we no longer read dies of it: that is not its fault.
  if (failure.kind == "read" && err.find("Broken pipe") != std::string::npos) return "misleading";
  for (const auto& [name, bytes] : met.files) {
    const auto whole = sound.files.find(name);
    if (whole == sound.files.end()) return name + " is left over";
    if (whole->second != bytes) return name + " is not whole";
  }
  if (status != 0) return "";
  if (out != sound.ended.out) return "the standard output is not whole";
  for (const auto& [name, bytes] : sound.files) {
    // All else is there where a picture cannot be painted, and it is said.
    const bool told = err.find(name + " is not painted") != std::string::npos;
    if (!met.files.contains(name) && !told) return name + " is missing";
  }
  return "";
}

// Which calls fail: half of them anywhere, half of them rather early.
std::vector<Failure> drawn_failures(const std::map<std::string, long>& counts, std::mt19937& random,
                                    bool is_slow) {
  const std::map<std::string, std::pair<int, int>> plan = {
      {"allocate", {8, ENOMEM}}, {"write", {3, ENOSPC}}, {"read", {2, EIO}},  {"open", {2, EMFILE}},
      {"sync", {1, EIO}},        {"close", {1, EIO}},    {"rename", {1, EIO}}};
  std::vector<Failure> failures;
  for (const auto& [kind, times] : plan) {
    const long all = counts.at(kind);
    const int wanted = (is_slow ? (times.first + 1) / 2 : times.first) * (sample().all ? 10 : 1);
    for (int i = 0; i < wanted && all > 0; ++i) {
      const double share = static_cast<double>(random()) / 4294967296.0;
      const double at =
          i % 2 == 0 ? share * static_cast<double>(all) : std::pow(static_cast<double>(all), share);
      const auto number = std::clamp(1 + static_cast<long>(at), 1L, all);
      const bool other = kind == "write" && i % 2 == 1;
      const bool on = i == 0 && (kind == "allocate" || kind == "write");
      failures.push_back({kind, number, other ? EIO : times.second, on});
    }
  }
  return failures;
}

TEST_P(Failing, EndsWithASentenceAndNothingHalf) {
  EVERY_FOURTH_LANDING();
  if (!kAddressesMayBeLimited) GTEST_SKIP() << "a sanitizer has a malloc of its own";
  measure();
  const auto& verb = GetParam();
  std::mt19937 random(static_cast<unsigned>(seed()));
  fmt::print("{}: calls drawn by {} ({})\n", verb.name, seed(), sample().from);
  const auto first = answer(verb, {});
  ASSERT_NE(first.ended.status, 5) << first.ended.err;
  for (const bool cached : {false, true}) {
    (void)answer(verb, {.cached = cached});
    const auto sound = answer(verb, {.cached = cached, .counts = true});
    ASSERT_EQ(sound.files, first.files);
    for (const auto& failure : drawn_failures(counts(), random, verb.is_slow)) {
      const auto met = answer(verb, {.failure = failure, .cached = cached});
      const auto what = fault(sound, met, failure);
      EXPECT_EQ(what, "") << fmt::format("chladni {}", fmt::join(verb.words, " ")) << "\n"
                          << failure.text() << (cached ? " with kept modes" : "") << "\n"
                          << met.ended.err;
    }
  }
}

// A sweep leaves what its variants left, and says which of them failed: it goes on from there.
TEST_F(FailingSweep, GoesOnAfterwards) {
  EVERY_FOURTH_LANDING();
  if (!kAddressesMayBeLimited) GTEST_SKIP() << "a sanitizer has a malloc of its own";
  std::mt19937 random(static_cast<unsigned>(seed()));
  const Verb sweep{"sweep", words()};
  auto again = sweep;
  again.words.emplace_back("--retry");
  const auto sound = without_times(answer(sweep, {.counts = true}).files);
  ASSERT_TRUE(sound.contains("table.csv"));
  for (const auto& failure : drawn_failures(counts(), random, true)) {
    SCOPED_TRACE(failure.text());
    const auto met = answer(sweep, {.failure = failure});
    const std::set<int> allowed{0, 4, 5};
    EXPECT_TRUE(allowed.contains(met.ended.status)) << met.ended.status << "\n" << met.ended.err;
    EXPECT_EQ(met.ended.err.find("fault of Chladni"), std::string::npos) << met.ended.err;
    const auto later = answer(again, {.keeps = true});
    EXPECT_EQ(later.ended.status, 0) << later.ended.err;
    EXPECT_EQ(without_times(later.files), sound);
  }
}

TEST_P(Failing, TakesShortAndInterruptedCalls) {
  EVERY_FOURTH_LANDING();
  if (!kAddressesMayBeLimited) GTEST_SKIP() << "a sanitizer has a malloc of its own";
  measure();
  const auto sound = answer(GetParam(), {});
  const auto met = answer(GetParam(), {.is_short = true});
  EXPECT_EQ(met.ended.status, sound.ended.status) << met.ended.err;
  EXPECT_EQ(met.ended.out, sound.ended.out);
  EXPECT_EQ(met.files, sound.files);
}

INSTANTIATE_TEST_SUITE_P(Verb, Failing, testing::ValuesIn(all_verbs()),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace chladni::app
