// What is said where a solution does not fit: each way is gone as it is printed.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "host/worker.h"
#include "io/json.h"
#include "tests/app/program.h"
#include "tests/rotation/turn.h"

namespace chladni::app {
namespace {

constexpr double kLimitGb = 0.065;

io::Json modes_in(const fs::path& folder) { return io::parse_json(whole(folder / "modes.json")); }

class Remedies : public CommandLine {
 public:
  /// The plate of tests/app/program.h on these elements.
  static std::string plate(const std::string& edge, int order) {
    auto text = std::string(kPlate);
    const std::string before = "edge_length = \"10 mm\", order = 2";
    return text.replace(text.find(before), before.size(),
                        fmt::format("edge_length = \"{}\", order = {}", edge, order));
  }

 protected:
  /// Flexible frequencies that `modes` leaves.
  std::vector<double> frequencies(const std::string& study,
                                  const std::vector<std::string>& options) {
    std::vector<std::string> words = {
        "modes", write("tried.toml", study).string(), "-o", "out", "--no-pictures", "--no-cache"};
    words.insert(words.end(), options.begin(), options.end());
    last_ = ended(started(words, "", [] {
      for (const auto* allowed : {"OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM",
                                  "OMPI_MCA_rmaps_base_oversubscribe"}) {
        setenv(allowed, "1", 1);
      }
    }));
    EXPECT_EQ(last_.status, 0) << last_.err;
    if (last_.status != 0) return {};
    std::vector<double> hz;
    const auto modes = modes_in(folder_ / "out");
    const auto& all = modes.at("frequency_hz").array();
    for (std::size_t i = 6; i < all.size(); ++i) hz.push_back(all[i].number());
    return hz;
  }

  /// The ways that a refusal tells, and its text in last_.
  io::Json refused(const std::string& study) {
    last_ = run({"modes", write("study.toml", study).string(), "-o", "refused", "--json",
                 "--memory-limit", fmt::to_string(kLimitGb)});
    EXPECT_EQ(last_.status, 5) << last_.err;
    EXPECT_TRUE(left("refused").empty());
    return io::parse_json(last_.out).at("error").at("remedies");
  }

  const std::vector<std::string> limited_ = {"--memory-limit", fmt::to_string(kLimitGb)};
  Ended last_;
};

// The keys that a way tells, in the study as a user would write them.
std::string plate_with(const io::Json& keys) {
  std::string text = Remedies::plate("6 mm", 2);
  const auto replace = [&](const std::string& before, const std::string& after) {
    const auto at = text.find(before);
    ASSERT_NE(at, std::string::npos) << before;
    text.replace(at, before.size(), after);
  };
  for (const auto& [table, values] : std::get<io::JsonObject>(keys.value())) {
    for (const auto& [key, value] : std::get<io::JsonObject>(values.value())) {
      if (key == "edge_length") replace("\"6 mm\"", "\"" + value.string() + "\"");
      if (key == "order") replace("order = 2", fmt::format("order = {}", value.number()));
      if (key != "mirrors") continue;
      std::string axes;
      for (const auto& axis : value.array()) axes += "\"" + axis.string() + "\", ";
      replace("count = 4", "count = 4, mirrors = [" + axes + "]");
    }
  }
  return text;
}

// The largest relative excess of the frequencies over others.
double excess(const std::vector<double>& hz, const std::vector<double>& over) {
  EXPECT_EQ(hz.size(), over.size());
  double worst = -1.0;
  for (std::size_t i = 0; i < std::min(hz.size(), over.size()); ++i) {
    worst = std::max(worst, hz[i] / over[i] - 1.0);
  }
  return worst;
}

TEST_F(Remedies, AreMeshesThatFitAndKeepTheirError) {
  const auto ways = refused(plate("6 mm", 2));
  const auto told = last_.err;
  const auto truth = frequencies(plate("6 mm", 3), {});
  std::vector<std::string> kinds;
  for (const auto& way : ways.array()) {
    kinds.push_back(way.at("kind").string());
    if (kinds.back() == "ranks") continue;
    const auto hz = frequencies(plate_with(way.at("study")), limited_);
    EXPECT_LT(way.at("memory_bytes").number(), 1e9 * kLimitGb);
    const auto& mesh = way.at("study").at("mesh");
    const bool mirrored = kinds.back() == "mirror symmetry";
    EXPECT_TRUE(says(told, fmt::format("mesh.edge_length = \"{}\", mesh.order = {}{}: ",
                                       mesh.at("edge_length").string(), mesh.at("order").number(),
                                       mirrored ? ", modes.mirrors = [\"x\", \"y\", \"z\"]" : "")));
    const double bound = way.at("frequency_error").number();
    EXPECT_LT(excess(hz, truth), bound) << kinds.back();
    EXPECT_GT(excess(hz, truth), bound / 10.0) << kinds.back();
    EXPECT_NEAR(way.at("highest_hz").number(), hz.back(), 1e-6 * hz.back());
  }
  EXPECT_EQ(kinds,
            (std::vector<std::string>{"coarser mesh", "cubic cells", "mirror symmetry", "ranks"}));
}

TEST_F(Remedies, AreRanksOfTheMemoryThatIsTold) {
  EVERY_EIGHTH_LANDING();
  if (!program_on_path("mpiexec")) GTEST_SKIP() << "no mpiexec on the PATH";
  if (!fs::exists(CHLADNI_BINARY_DIR "/bin/chladni-slepc")) {
    GTEST_SKIP() << "chladni-slepc is not built";
  }
  const auto study = plate("6 mm", 2);
  const auto ways = refused(study).array();
  const auto& way = ways.back();
  ASSERT_EQ(way.at("kind").string(), "ranks");
  const auto& option = way.at("options").array();
  EXPECT_TRUE(says(last_.err, fmt::format("{} \"{}\": the same mesh by ", option[0].string(),
                                          option[1].string())));
  auto options = limited_;
  for (const auto& word : option) options.push_back(word.string());
  EXPECT_FALSE(frequencies(study, options).empty());
  const auto modes = modes_in(folder_ / "out");
  const auto& peaks = modes.at("ranks").at("peak_memory_bytes").array();
  EXPECT_EQ(static_cast<double>(peaks.size()), way.at("ranks").number());
  for (const auto& peak : peaks) {
    EXPECT_LT(peak.number(), way.at("rank_bytes").number());
  }
}

TEST_F(Remedies, AreNoneWhereNothingFits) {
  const auto refused = run({"modes", write("study.toml", plate("6 mm", 2)).string(), "-o", "out",
                            "--json", "--memory-limit", "0.04"});
  EXPECT_EQ(refused.status, 5);
  EXPECT_TRUE(says(refused.err, "no coarser mesh fits"));
  EXPECT_FALSE(says(refused.out, "remedies"));
}

TEST_F(Remedies, AreToldByCheckToo) {
  const auto refused = run({"check", write("study.toml", plate("6 mm", 2)).string(), "-o", "out",
                            "--memory-limit", fmt::to_string(kLimitGb)});
  EXPECT_EQ(refused.status, 5);
  EXPECT_TRUE(says(refused.err, "what fits:\n  mesh.edge_length = \""));
}

}  // namespace
}  // namespace chladni::app
