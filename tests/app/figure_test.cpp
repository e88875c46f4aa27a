// Figures for a paper from results that are there.
#include <algorithm>
#include <cstdint>

#include "io/json.h"
#include "show/version.h"
#include "tests/app/program.h"

namespace chladni::app {
namespace {

class FigureVerb : public CommandLine {
 protected:
  /// A folder as `compare` leaves it.
  void leave_comparison(const std::string& folder, const std::string& version = show::version()) {
    fs::create_directories(folder_ / folder);
    write(folder + "/comparison.json", R"({
"chladni": ")" + version + R"(",
"modes": [{"simulated_mode": 7, "measured_mode": 1, "simulated_hz": 100.0, "measured_hz": 103.0,
 "change": 0.03, "change_std": 0.001}, {"simulated_mode": 8, "measured_mode": 2,
 "simulated_hz": 250.0, "measured_hz": 245.0, "change": -0.02, "change_std": null}],
"simulated_alone": [], "simulated_unseen": [], "measured_alone": [], "no_modes": [],
"mac": {"simulated_modes": [7, 8], "measured_modes": [1, 2], "value": [[0.97, 0.05], [0.04, 0.93]]},
"sensors": [{"name": "s1"}, {"name": "s2"}], "actuators": [{"name": "a1"}],
"per_channel": [{"sensor": "s1", "actuator": "a1", "relative_error": 0.23},
 {"sensor": "s2", "actuator": "a1", "relative_error": null}]})");
  }
  static std::uint32_t word(const std::string& bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      value = (value << 8U) | static_cast<unsigned char>(bytes.at(at + k));
    }
    return value;
  }
};

TEST_F(FigureVerb, WhatIsStoredIsDrawnForPaper) {
  leave_comparison("out");
  const auto done = run({"figure", "out", "--width", "88", "--dpi", "300"});
  ASSERT_EQ(done.status, 0) << done.err;
  for (const auto* name : {"frequency_errors", "mac", "errors"}) {
    const auto svg = whole(folder_ / "out" / (std::string(name) + ".svg"));
    EXPECT_TRUE(says(svg, "width=\"88mm\"")) << name;
    const auto png = whole(folder_ / "out" / (std::string(name) + ".png"));
    ASSERT_GT(png.size(), 60U) << name;
    EXPECT_NEAR(word(png, 16), 88.0 / 25.4 * 300.0, 1.0) << name;
    EXPECT_EQ(png.substr(37, 4), "pHYs");
    EXPECT_EQ(word(png, 41), 11811U);  // 300 pixels per inch, per metre
  }
  const auto errors = whole(folder_ / "out/errors.svg");
  EXPECT_FALSE(says(errors, "Error of each response"));  // the caption has it
  const auto mac = whole(folder_ / "out/mac.svg");
  for (const auto* words : {"0.97", "0.93", "103 Hz", "250 Hz"}) EXPECT_TRUE(says(mac, words));
}

TEST_F(FigureVerb, OneFormatIntoAnotherFolder) {
  leave_comparison("out");
  const auto done =
      run({"figure", "out/comparison.json", "mac", "-o", "paper", "--format", "svg", "--json"});
  ASSERT_EQ(done.status, 0) << done.err;
  const auto names = left("paper");
  EXPECT_EQ(std::ranges::count(names, "mac.svg"), 1);
  EXPECT_EQ(std::ranges::count(names, "mac.png"), 0);
  EXPECT_EQ(left("out"), std::vector<std::string>{"comparison.json"});
  const auto json = io::parse_json(done.out);
  ASSERT_EQ(json.at("figures").array().size(), 1U);
  EXPECT_EQ(json.at("figures").array()[0].at("from").string(), "comparison.json");
}

TEST_F(FigureVerb, ListDrawsNothingAndSaysWhyNot) {
  leave_comparison("out");
  write("out/responses.png", "a picture");
  const auto done = run({"figure", "out", "--list"});
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_TRUE(says(done.out, "frequency_errors"));
  EXPECT_TRUE(says(done.out, "not drawn: its curves are not stored"));
  EXPECT_EQ(left("out").size(), 2U);
  const auto asked = run({"figure", "out", "responses"});
  EXPECT_EQ(asked.status, 3);
  EXPECT_TRUE(says(asked.err, "\"responses\" cannot be drawn: its curves are not stored"));
  EXPECT_TRUE(says(run({"figure", "out", "mca"}).err, "there is no figure \"mca\""));
}

TEST_F(FigureVerb, WhatIsNoResultIsRefused) {
  const auto missing = run({"figure", "nowhere"});
  EXPECT_EQ(missing.status, 3);
  EXPECT_TRUE(says(missing.err, "there is no such folder"));
  fs::create_directories(folder_ / "empty");
  EXPECT_EQ(run({"figure", "empty"}).status, 3);
  leave_comparison("out");
  const auto whole_text = whole(folder_ / "out/comparison.json");
  write("out/comparison.json", whole_text.substr(0, whole_text.size() / 2));
  const auto cut = run({"figure", "out"});
  EXPECT_EQ(cut.status, 3);
  EXPECT_TRUE(says(cut.err, "comparison.json: not the whole result"));
  EXPECT_EQ(left("out"), std::vector<std::string>{"comparison.json"});
}

TEST_F(FigureVerb, AnotherVersionIsNamedWhereItsDataAreOthers) {
  fs::create_directories(folder_ / "out");
  write("out/comparison.json", R"({"chladni": "0.0.1+g1", "modes": []})");
  const auto done = run({"figure", "out", "mac"});
  EXPECT_EQ(done.status, 3);
  EXPECT_TRUE(says(done.err, "it is of Chladni 0.0.1"));
  leave_comparison("old", "0.0.1+g1");  // the same data are drawn
  EXPECT_EQ(run({"figure", "old", "--format", "svg"}).status, 0);
}

}  // namespace
}  // namespace chladni::app
