// The same input gives identical files, run after run.
#include <map>

#include "rotation/turn.h"
#include "tests/app/program.h"

namespace chladni::app {
namespace {

class Repeats : public CommandLine {
 protected:
  std::map<std::string, std::string> files(const std::string& out) const {
    std::map<std::string, std::string> all;
    for (const auto& name : left(out)) all[name] = whole(folder_ / out / name);
    return all;
  }

  void expect_the_same(const std::map<std::string, std::string>& first,
                       const std::map<std::string, std::string>& again) const {
    ASSERT_EQ(first.size(), again.size());
    for (const auto& [name, bytes] : first) {
      ASSERT_EQ(again.count(name), 1U) << name;
      EXPECT_TRUE(again.at(name) == bytes) << name;
    }
  }

  /// Everything: modes.json, modes.csv, modes.vtu, modes.png, mesh.vtu, channels.vtu, report.html.
  std::map<std::string, std::string> study(const std::string& file) const {
    const auto done = run({"study", file, "-o", "out", "--reproducible", "--quiet"});
    EXPECT_EQ(done.status, 0) << done.err;
    auto all = files("out");
    fs::remove_all(folder_ / "out");
    return all;
  }
};

// A square plate: its pairs must come in the same orientation every time.
TEST_F(Repeats, TwentyRunsGiveTheSameBytes) {
  EVERY_FOURTH_LANDING();
  std::string text = kPlate;
  text.replace(text.find("60 mm"), 5, "100 mm");
  const auto file = write("study.toml", text).string();
  const auto first = study(file);
  for (const auto* name : {"modes.json", "modes.csv", "modes.vtu", "modes.png", "report.html"}) {
    EXPECT_EQ(first.count(name), 1U) << name;
  }
  for (int again = 1; again < 20; ++again) expect_the_same(first, study(file));
}

TEST_F(Repeats, TheOatTableTwice) {
  EVERY_FOURTH_LANDING();
  const std::string file = CHLADNI_SOURCE_DIR "/models/oat/minimal/study.toml";
  const auto first = study(file);
  EXPECT_GE(first.size(), 8U);
  expect_the_same(first, study(file));
}

}  // namespace
}  // namespace chladni::app
