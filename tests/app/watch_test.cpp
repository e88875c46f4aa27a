// --watch: what an editor does to the files of a study, while it waits.
#include <chrono>
#include <csignal>
#include <thread>

#include "app/command_line/watch.h"
#include "io/json.h"
#include "tests/app/program.h"

namespace chladni::app {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kPatience = 60s;

class Watching : public CommandLine {
 protected:
  void TearDown() override {
    if (child_ > 0) end();
    CommandLine::TearDown();
  }

  void start(const std::vector<std::string>& words) {
    auto all = words;
    for (const auto* word : {"--watch", "-o", "out", "--no-pictures"}) all.emplace_back(word);
    child_ = started(all, "", [&] { setenv("CHLADNI_CACHE", (folder_ / "kept").c_str(), 1); });
  }
  Ended end(int signal = SIGINT) {
    kill(child_, signal);
    return ended(std::exchange(child_, -1));
  }

  [[nodiscard]] std::string said() const { return whole(folder_ / "stderr"); }
  [[nodiscard]] int times(const std::string& part) const {
    const auto text = said();
    int count = 0;
    for (auto at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++count;
    return count;
  }
  // Whether it waits for the time of this number, counted from 1.
  [[nodiscard]] testing::AssertionResult waits(int number) const {
    const auto end = std::chrono::steady_clock::now() + kPatience;
    while (times("waiting for a change of ") < number) {
      if (std::chrono::steady_clock::now() > end) {
        return testing::AssertionFailure() << "not the " << number << ". time:\n" << said();
      }
      std::this_thread::sleep_for(20ms);
    }
    return testing::AssertionSuccess();
  }
  // Beside the six rigid-body modes.
  [[nodiscard]] std::size_t modes() const {
    return io::parse_json(whole(folder_ / "out/modes.json")).at("frequency_hz").array().size() - 6;
  }
  static std::string with_modes(int count) {
    std::string text = kPlate;
    return text.replace(text.find("count = 4"), 9, "count = " + std::to_string(count));
  }

  pid_t child_ = -1;
};

TEST_F(Watching, RunsAgainWhenTheStudyIsWrittenInPlace) {
  const auto study = write("study.toml", with_modes(9)).string();
  start({"modes", study});
  ASSERT_TRUE(waits(1));
  EXPECT_EQ(modes(), 9U);
  write("study.toml", with_modes(8));
  ASSERT_TRUE(waits(2));
  EXPECT_TRUE(says(said(), "\nstudy.toml has changed: once more\n"));
  EXPECT_TRUE(says(said(), "modes of an earlier run")) << "the second run solved anew";
  EXPECT_EQ(modes(), 8U);
  const auto over = end();
  EXPECT_EQ(over.status, 130);
  EXPECT_TRUE(says(over.err, "error: stopped by Ctrl-C\n"));
  EXPECT_EQ(left("out"),
            (std::vector<std::string>{"channels.vtu", "modes.csv", "modes.json", "modes.vtu"}));
}

TEST_F(Watching, RunsAgainWhenTheStudyIsReplacedByRenaming) {
  const auto study = write("study.toml", with_modes(9)).string();
  start({"modes", study});
  ASSERT_TRUE(waits(1));
  // vim: the old file gets another name, then the new one is written, then the old one goes.
  const auto begin = Clock::now();
  fs::rename(study, folder_ / "study.toml~");
  std::this_thread::sleep_for(150ms);
  write("study.toml", with_modes(8));
  if (Clock::now() - begin > 800ms) GTEST_SKIP() << "the machine is too busy for this editor";
  fs::remove(folder_ / "study.toml~");
  ASSERT_TRUE(waits(2));
  EXPECT_EQ(modes(), 8U);
  // Others: the new file is written beside it and takes its name.
  write("other", with_modes(7));
  fs::rename(folder_ / "other", study);
  ASSERT_TRUE(waits(3));
  EXPECT_EQ(modes(), 7U);
  EXPECT_EQ(times("study.toml has changed: once more\n"), 2);
  EXPECT_EQ(times("error: "), 0);
}

TEST_F(Watching, GoesOnAfterAStudyThatIsHalfWrittenOrGone) {
  const auto study = write("study.toml", with_modes(9)).string();
  start({"modes", study});
  ASSERT_TRUE(waits(1));
  write("study.toml", std::string(kPlate).substr(0, 100));
  ASSERT_TRUE(waits(2));
  EXPECT_EQ(times("error: "), 1) << said();
  fs::remove(study);
  ASSERT_TRUE(waits(3));
  EXPECT_TRUE(says(said(), "study.toml is gone: once more\n"));
  EXPECT_EQ(times("error: "), 2) << said();
  write("study.toml", with_modes(8));
  ASSERT_TRUE(waits(4));
  EXPECT_EQ(modes(), 8U);
  EXPECT_EQ(times("error: "), 2) << said();
  EXPECT_EQ(end(SIGTERM).status, 130);
}

TEST_F(Watching, TakesWhatIsWrittenSlowlyAsOneChange) {
  const auto study = write("study.toml", with_modes(9)).string();
  start({"modes", study});
  ASSERT_TRUE(waits(1));
  const auto text = with_modes(8);
  std::ofstream stream(study, std::ios::trunc);
  for (std::size_t at = 0; at < text.size(); at += 60) {
    const auto begin = Clock::now();
    stream << text.substr(at, 60) << std::flush;
    std::this_thread::sleep_for(100ms);
    if (Clock::now() - begin > 250ms) GTEST_SKIP() << "the machine is too busy for this editor";
  }
  ASSERT_TRUE(waits(2));
  EXPECT_EQ(modes(), 8U);
  EXPECT_EQ(times("error: "), 0) << said();
}

TEST_F(Watching, HearsOfEveryFileThatTheStudyNames) {
  write("base.toml", with_modes(9));
  const auto study = write("study.toml", R"(extends = "base.toml"
[[actuator]]
name = "a"
at = { csv = "places.csv" }
direction = "z"
)");
  start({"modes", study.string()});
  ASSERT_TRUE(waits(1)) << "a file that is not there is waited for";
  EXPECT_EQ(times("error: "), 1) << said();
  EXPECT_TRUE(says(said(), "waiting for a change of study.toml, base.toml, places.csv;"));
  write("places.csv", "x_mm,y_mm\n10,0\n");
  ASSERT_TRUE(waits(2));
  EXPECT_TRUE(says(said(), "places.csv has changed: once more\n"));
  EXPECT_EQ(times("error: "), 1) << said();
  EXPECT_EQ(modes(), 9U);
  write("base.toml", with_modes(8));
  ASSERT_TRUE(waits(3));
  EXPECT_TRUE(says(said(), "base.toml has changed: once more\n"));
  EXPECT_EQ(modes(), 8U);
}

TEST_F(Watching, IsNotWokenByWhatItsVerbWrites) {
  const auto study = write("study.toml", std::string(kPlate) + R"([[support]]
patch = "x_min"
fixed = "xyz"
[[actuator]]
name = "a1"
at = ["30 mm", "-15 mm"]
direction = "z"
[experiment]
sample_rate = "40 kHz"
samples = 256
[measurement]
frf = "rig.csv"
)");
  start({"simulate", study.string()});
  ASSERT_TRUE(waits(1));
  ASSERT_TRUE(fs::exists(folder_ / "rig.csv")) << said();
  std::this_thread::sleep_for(1500ms);
  EXPECT_EQ(times("once more"), 0) << said();
}

// A study that is saved while it runs has changed, wherever the results go.
TEST_F(Watching, NoRunWritesTheStudyThatItReads) {
  EXPECT_TRUE(is_written(modes_command, ".", "modes.json"));
  EXPECT_FALSE(is_written(modes_command, ".", "study.toml"));
  EXPECT_FALSE(is_written(modes_command, "out", "rig.csv"));
  EXPECT_TRUE(is_written(simulate_command, "out", "rig.csv"));
  EXPECT_FALSE(is_written(simulate_command, "out", "rig.toml"));
}

TEST_F(Watching, SaysNothingButErrorsWhenQuiet) {
  const auto study = write("study.toml", "title = \"no study\"\n").string();
  start({"modes", study, "--quiet"});
  for (int i = 0; i < 3000 && times("error: ") == 0; ++i) std::this_thread::sleep_for(20ms);
  std::this_thread::sleep_for(300ms);
  write("study.toml", kPlate);
  for (int i = 0; i < 3000 && !fs::exists(folder_ / "out/modes.vtu"); ++i) {
    std::this_thread::sleep_for(20ms);
  }
  EXPECT_EQ(modes(), 4U);
  EXPECT_EQ(times("waiting"), 0);
  EXPECT_EQ(times("once more"), 0);
}

TEST_F(Watching, EndsWithARunThatIsInterrupted) {
  std::string text = kPlate;
  text.replace(text.find("\"10 mm\", order = 2"), 18, "\"3 mm\", order = 3");
  start({"modes", write("study.toml", text).string()});
  for (int i = 0; i < 3000 && times("forecast") == 0; ++i) std::this_thread::sleep_for(10ms);
  const auto over = end();
  EXPECT_EQ(over.status, 130);
  EXPECT_TRUE(says(over.err, "stopped by Ctrl-C"));
  EXPECT_FALSE(says(over.err, "waiting for a change"));
}

}  // namespace
}  // namespace chladni::app
