// --engine and [modes] engine of the program.
#include <cstdlib>

#include "host/worker.h"
#include "io/json.h"
#include "tests/app/program.h"

namespace chladni::app {
namespace {

// Why no ranks can be started here; empty where they can.
std::string no_ranks() {
  if (!program_on_path("mpiexec")) return "no mpiexec on the PATH";
  if (!fs::exists(CHLADNI_BINARY_DIR "/bin/chladni-slepc")) return "chladni-slepc is not built";
  return "";
}

constexpr const char* kTwoRanks = "mpiexec --allow-run-as-root --oversubscribe -n 2";

io::Json modes_in(const fs::path& folder) { return io::parse_json(whole(folder / "modes.json")); }

class EngineOfModes : public CommandLine {};

TEST_F(EngineOfModes, GivesWhatThisProcessGives) {
  if (const auto why = no_ranks(); !why.empty()) GTEST_SKIP() << why;
  const auto study = write("study.toml", kPlate).string();
  ASSERT_EQ(run({"modes", study, "-o", "own", "--no-pictures"}).status, 0);
  const auto ended = run({"modes", study, "-o", "out", "--no-pictures", "--engine", kTwoRanks});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_TRUE(says(ended.out, "by MUMPS on 2 ranks"));
  const auto own = modes_in(folder_ / "own");
  const auto out = modes_in(folder_ / "out");
  const auto& hz = out.at("frequency_hz").array();
  ASSERT_EQ(hz.size(), own.at("frequency_hz").array().size());
  for (std::size_t i = 6; i < hz.size(); ++i) {
    EXPECT_NEAR(hz[i].number() / own.at("frequency_hz").array()[i].number(), 1.0, 1e-9);
    EXPECT_NEAR(out.at("sensors").at("s1").array()[i].number(),
                own.at("sensors").at("s1").array()[i].number(), 1e-5);
  }
  EXPECT_EQ(out.at("certificate").at("found").number(),
            out.at("certificate").at("counted").number());
  EXPECT_EQ(out.at("ranks").at("peak_memory_bytes").array().size(), 2U);
  EXPECT_EQ(left("out"), left("own"));
}

// A body for which this process is not given the memory.
TEST_F(EngineOfModes, SolvesWhatThisProcessRefuses) {
  if (const auto why = no_ranks(); !why.empty()) GTEST_SKIP() << why;
  auto text = std::string(kPlate);
  text.replace(text.find("10 mm"), 5, "6 mm");
  const auto study = write("study.toml", text).string();
  const std::vector<std::string> few = {"modes",          study,  "-o", "out", "--no-pictures",
                                        "--memory-limit", "0.065"};
  const auto refused = run(few);
  EXPECT_EQ(refused.status, 5) << refused.err;
  EXPECT_TRUE(says(refused.err, "--engine"));
  auto by_ranks = few;
  by_ranks.insert(by_ranks.end(), {"--engine", kTwoRanks});
  const auto solved = run(by_ranks);
  EXPECT_EQ(solved.status, 0) << solved.err;
}

TEST_F(EngineOfModes, ThatIsMissingIsAnError) {
  const auto study = write("study.toml", kPlate).string();
  const auto ended = run({"modes", study, "-o", "out", "--engine", "mpiexec-of-nobody -n 4"});
  EXPECT_EQ(ended.status, 6);
  EXPECT_TRUE(says(ended.err, "mpiexec-of-nobody"));
  EXPECT_TRUE(left("out").empty());
}

// A study may not start any program.
TEST_F(EngineOfModes, OfAStudyIsAPlainLauncher) {
  for (const auto* engine :
       {"sh -c ls", "mpiexec -n 4 /bin/true", "./mpiexec -n 4", "mpiexec -n 4 --prefix /tmp", "",
        "mpiexec -x LD_PRELOAD=a.so -n 2", "mpiexec -n 4; ls"}) {
    auto text = std::string(kPlate);
    text.replace(text.find("count = 4"), 9, "count = 4, engine = \"" + std::string(engine) + "\"");
    const auto ended = run({"check", write("study.toml", text).string(), "-o", "out"});
    EXPECT_EQ(ended.status, 3) << engine;
    EXPECT_TRUE(says(ended.err, "modes.engine")) << engine;
  }
}

TEST_F(EngineOfModes, OfAStudyIsUsed) {
  if (const auto why = no_ranks(); !why.empty()) GTEST_SKIP() << why;
  auto text = std::string(kPlate);
  text.replace(text.find("count = 4"), 9, "count = 4, engine = \"" + std::string(kTwoRanks) + "\"");
  const auto ended =
      run({"modes", write("study.toml", text).string(), "-o", "out", "--no-pictures"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_TRUE(says(ended.out, "by MUMPS on 2 ranks"));
}

}  // namespace
}  // namespace chladni::app
