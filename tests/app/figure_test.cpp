// Figures for a paper from results that are there.
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>

#include "io/json.h"
#include "show/figures/stored_curves.h"
#include "show/identification/response_curves.h"
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

/// Two responses of a mode at 100 Hz, of which the second is measured with a band.
io::Curves two_responses() {
  const Eigen::VectorXd hz = Eigen::VectorXd::LinSpaced(200, 50.0, 150.0);
  const auto response = [&](double scale) -> Eigen::VectorXcd {
    return hz.cast<std::complex<double>>().unaryExpr([&](std::complex<double> f) {
      return scale * 1e-6 / (1e4 - f * f + std::complex<double>(0.0, 200.0));
    });
  };
  std::vector<show::OneResponse> all{{"s1 by a1", response(1.0), {}, {response(1.1)}},
                                     {"s2 by a1", response(-2.0), {}, {response(-1.0)}}};
  all[1].deviation = 0.05 * response(2.0).cwiseAbs();
  return show::response_curves(hz, {{"fitted", 1}}, all, "receptance [m/N]");
}

TEST_F(FigureVerb, StoredCurvesAreTheSame) {
  const auto curves = two_responses();
  const auto again = show::stored_curves(io::parse_json(io::text(show::curves_json(curves))));
  EXPECT_EQ(again.axis.label, "frequency [Hz]");
  ASSERT_EQ(again.choices.size(), 2U);
  EXPECT_EQ(again.choices[0].name, "s2 by a1, off by 50 %");
  for (std::size_t c = 0; c < 2; ++c) {
    ASSERT_EQ(again.choices[c].y.size(), curves.choices[c].y.size());
    for (std::size_t k = 0; k < curves.choices[c].y.size(); ++k) {
      const auto& y = curves.choices[c].y[k];
      ASSERT_EQ(again.choices[c].y[k].size(), y.size());
      EXPECT_TRUE(y.size() == 0 || again.choices[c].y[k].isApprox(y, 1e-6));
    }
  }
}

// Axes with units and levels, the band, a legend; the worst response first.
TEST_F(FigureVerb, ResponsesAreDrawnFromTheirCurves) {
  leave_comparison("out");
  auto json = show::curves_json(two_responses());
  json.emplace_back("chladni", show::version());
  write("out/fit_curves.json", io::text(json));
  write("out/fit.png", "of the verb");
  const auto done = run({"figure", "out", "fit", "fit:s2/a1", "--format", "svg", "-o", "paper"});
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(left("paper"), (std::vector<std::string>{"fit.svg", "fit_s2_a1.svg"}));
  const auto all = whole(folder_ / "paper/fit.svg");
  for (const auto* words : {"s1 by a1", "s2 by a1", "receptance [m/N]", "frequency [Hz]",
                            "95 % band", "measured", "fitted", ">100<"}) {
    EXPECT_TRUE(says(all, words));
  }
  EXPECT_FALSE(says(all, "phase"));
  EXPECT_FALSE(says(all, "off by"));
  const auto one = whole(folder_ / "paper/fit_s2_a1.svg");
  for (const auto* words : {"s2 by a1", "phase [deg]", "receptance [m/N]", "95 % band"}) {
    EXPECT_TRUE(says(one, words));
  }
  EXPECT_FALSE(says(one, "s1 by a1"));
  // What is not known has no band.
  ASSERT_EQ(run({"figure", "out", "fit:s1/a1", "--format", "svg", "-o", "paper"}).status, 0);
  EXPECT_FALSE(says(whole(folder_ / "paper/fit_s1_a1.svg"), "95 % band"));
  const auto list = run({"figure", "out", "--list"});
  EXPECT_FALSE(says(list.out, "its curves are not stored"));
}

TEST_F(FigureVerb, APartThatIsNotThereIsRefused) {
  leave_comparison("out");
  write("out/fit_curves.json", io::text(show::curves_json(two_responses())));
  const auto other = run({"figure", "out", "fit:s3/a1"});
  EXPECT_EQ(other.status, 3);
  EXPECT_TRUE(says(other.err, R"(no curves of "s3/a1"; expected "s2/a1" or "s1/a1")"));
  EXPECT_TRUE(says(run({"figure", "out", "fit:s2"}).err, R"("s2" is no response; expected)"));
  EXPECT_TRUE(says(run({"figure", "out", "mac:s1/a1"}).err, R"("mac" has no parts)"));
  auto text = whole(folder_ / "out/fit_curves.json");
  text.replace(text.find("\"band\""), 6, "\"line\"");
  write("out/fit_curves.json", text);
  EXPECT_TRUE(says(run({"figure", "out", "fit"}).err, "curves, expected"));
}

TEST_F(FigureVerb, ALongNameHasTheWholeWidth) {
  auto curves = two_responses();
  EXPECT_EQ(show::magnitudes_plot(curves).columns, 0);
  curves.choices[1].name = "accelerometer_upper_left by a1, off by 10 %";
  const auto plot = show::magnitudes_plot(curves);
  EXPECT_EQ(plot.columns, 1);
  EXPECT_EQ(plot.panels[1].title, "accelerometer_upper_left by a1");
}

// A phase that passes 180 degrees is no line from one end of the axis to the other.
TEST_F(FigureVerb, APhaseJumpsWithoutALine) {
  io::Curves curves = two_responses();
  for (auto& y : curves.choices[0].y) {
    if (y.size() > 0) y.setLinSpaced(200, 1.0, 170.0);
  }
  const auto smooth = show::response_plot(curves, "s2/a1");
  EXPECT_EQ(smooth.panels[1].series.back().y.size(), 200);
  curves.choices[0].y[5].tail(100).array() -= 360.0;  // fitted: behind band, two sizes, one phase
  const auto jumps = show::response_plot(curves, "s2/a1");
  const auto& phase = jumps.panels[1].series.back();
  EXPECT_EQ(phase.name, "fitted");
  ASSERT_EQ(phase.y.size(), 201);
  EXPECT_EQ(phase.x.size(), 201);
  EXPECT_TRUE(std::isnan(phase.y(100)));
}

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
    EXPECT_EQ(word(png, 41), 11811U);       // 300 pixels per inch, per metre
    EXPECT_EQ(word(png, 50), 0x78A53F76U);  // its checksum, by another program
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

// 76.2 mm are 3 inches: the product in floating point is a rounding above 900.
TEST_F(FigureVerb, WholePixelsStayWhole) {
  leave_comparison("out");
  const auto done = run({"figure", "out", "mac", "--width", "76.2", "--format", "png"});
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(word(whole(folder_ / "out/mac.png"), 16), 900U);
  EXPECT_FALSE(fs::exists(folder_ / "out/mac.svg"));
}

// An option takes one word, so names may stand behind it.
TEST_F(FigureVerb, OptionsMayStandBeforeTheNames) {
  leave_comparison("out");
  const auto before = run({"figure", "--format", "svg", "out", "mac"});
  ASSERT_EQ(before.status, 0) << before.err;
  EXPECT_EQ(left("out"), (std::vector<std::string>{"comparison.json", "mac.svg"}));
  const auto between = run({"figure", "out", "--format", "svg", "errors", "-o", "paper"});
  ASSERT_EQ(between.status, 0) << between.err;
  EXPECT_EQ(std::ranges::count(left("paper"), "errors.svg"), 1);
  EXPECT_EQ(std::ranges::count(left("paper"), "errors.png"), 0);
  const auto both = run({"figure", "--list", "--format", "svg,png", "out"});
  EXPECT_EQ(both.status, 0) << both.err;
  EXPECT_NE(run({"figure", "--format", "svg,pdf", "out"}).status, 0);
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

// The limit is that of the painter: 8192 px along a side, 20 million in all.
TEST_F(FigureVerb, WhatThePainterCannotDrawIsRefusedBeforeAFileIsWritten) {
  leave_comparison("out");
  for (const char* name : {"frequency_errors", "mac"}) {
    const auto done = run({"figure", "out", name, "--width", "400", "--dpi", "600", "-o", "paper"});
    EXPECT_EQ(done.status, 3) << name;
    EXPECT_TRUE(says(done.err, "at 400 mm at most ")) << name;
    EXPECT_FALSE(fs::exists(folder_ / "paper")) << name;
  }
  const auto all = run({"figure", "out", "--width", "400", "--dpi", "600", "-o", "paper"});
  EXPECT_EQ(all.status, 3);
  EXPECT_TRUE(says(all.err, "at 400 mm at most "));
  EXPECT_FALSE(fs::exists(folder_ / "paper"));
  // One that is too large is enough: 160 mm at 1100 dpi is for the flat `errors` only.
  const auto some = run({"figure", "out", "--dpi", "1100", "-o", "paper"});
  EXPECT_EQ(some.status, 3);
  EXPECT_TRUE(says(some.err, "at 160 mm at most "));
  EXPECT_FALSE(fs::exists(folder_ / "paper"));
  // An SVG has no pixels.
  const std::vector<std::string> lines = {"figure", "out",      "--width", "400", "--dpi",
                                          "600",    "--format", "svg",     "-o",  "lines"};
  EXPECT_EQ(run(lines).status, 0);
  EXPECT_EQ(left("lines").size(), 3U);
}

// A matrix of many rows is higher than wide; what fits at this width is drawn.
TEST_F(FigureVerb, TheHeightIsLimitedAsTheWidthIs) {
  std::string sensors;
  for (int i = 0; i < 150; ++i) {
    const auto name = "\"s" + std::to_string(i) + "\"";
    sensors += (i > 0 ? ", {\"name\": " : "{\"name\": ") + name + "}";
  }
  fs::create_directories(folder_ / "out");
  write("out/comparison.json", R"({"chladni": ")" + show::version() + R"(", "modes": [],
"sensors": [)" + sensors + R"(], "actuators": [{"name": "a1"}], "per_channel": []})");
  const auto done = run({"figure", "out", "errors", "--width", "88", "--dpi", "600"});
  EXPECT_EQ(done.status, 3);
  EXPECT_TRUE(says(done.err, "expected at most 8192 along a side"));
  EXPECT_EQ(left("out"), std::vector<std::string>{"comparison.json"});
}

TEST_F(FigureVerb, NamesThatLeaveNoRoomAreRefusedWithTheWidthThatDoes) {
  leave_comparison("out");
  auto text = whole(folder_ / "out/comparison.json");
  for (auto at = text.find("\"s1\""); at != std::string::npos; at = text.find("\"s1\"", at)) {
    text.replace(at, 4, "\"accelerometer_upper_left_z\"");
  }
  write("out/comparison.json", text);
  const auto narrow = run({"figure", "out", "errors", "--width", "40", "--format", "svg"});
  EXPECT_EQ(narrow.status, 3);
  const std::string words = "at 40 mm: it takes ";
  ASSERT_TRUE(says(narrow.err, words));
  EXPECT_EQ(left("out"), std::vector<std::string>{"comparison.json"});
  const auto enough = narrow.err.substr(narrow.err.find(words) + words.size(), 2);
  EXPECT_EQ(run({"figure", "out", "errors", "--width", enough, "--format", "svg"}).status, 0);
  EXPECT_EQ(
      run({"figure", "out", "errors", "--width", std::to_string(std::stoi(enough) - 1)}).status, 3);
  // Without a name the others are drawn, and the reason is told.
  const auto all = run({"figure", "out", "--width", "40", "--format", "svg"});
  EXPECT_EQ(all.status, 0) << all.err;
  EXPECT_TRUE(says(all.out, "not drawn: comparison.json: the names leave no room"));
}

// Modes that were compared alone have no MAC; a comparison beside them has.
TEST_F(FigureVerb, TheNextFileHasWhatTheFirstLacks) {
  fs::create_directories(folder_ / "out");
  write("out/diagnosis.json", R"({"chladni": ")" + show::version() + R"(", "discrepancy": null})");
  const auto alone = run({"figure", "out", "mac"});
  EXPECT_EQ(alone.status, 3);
  EXPECT_TRUE(says(alone.err, "a diagnosis by modes compared no responses"));
  EXPECT_FALSE(says(alone.err, "it is of Chladni"));
  leave_comparison("out");
  const auto both = run({"figure", "out", "mac", "--format", "svg", "--json"});
  ASSERT_EQ(both.status, 0) << both.err;
  const auto json = io::parse_json(both.out);
  EXPECT_EQ(json.at("figures").array()[0].at("from").string(), "comparison.json");
}

// As `compare` leaves it of modes: these have no numbers.
TEST_F(FigureVerb, AComparisonOfModesAloneSaysWhatItLacks) {
  fs::create_directories(folder_ / "out");
  write("out/comparison.json", R"({"chladni": ")" + show::version() + R"(", "modes":
[{"simulated_hz": 100.0, "measured_hz": 103.0, "change": 0.03, "mac": null}]})");
  for (const char* name : {"mac", "errors"}) {
    const auto done = run({"figure", "out", name});
    EXPECT_EQ(done.status, 3) << name;
    EXPECT_TRUE(says(done.err, "a comparison of modes alone has no MAC and no responses")) << name;
  }
  EXPECT_EQ(run({"figure", "out", "frequency_errors", "--format", "svg"}).status, 0);
}

TEST_F(FigureVerb, NumbersThatNumberNothingAreAReason) {
  leave_comparison("out");
  const auto text = whole(folder_ / "out/comparison.json");
  for (const char* number : {"1e300", "-1", "7.5"}) {
    auto other = text;
    other.replace(other.find("[7, 8]"), 6, std::string("[") + number + ", 8]");
    write("out/comparison.json", other);
    const auto done = run({"figure", "out", "mac"});
    EXPECT_EQ(done.status, 3) << number;
    EXPECT_TRUE(says(done.err, "expected a whole number")) << number;
  }
}

TEST_F(FigureVerb, AnotherVersionIsNamedWhereItsDataAreOthers) {
  fs::create_directories(folder_ / "out");
  write("out/comparison.json", R"({"chladni": "0.0.1+g1", "modes": []})");
  const auto done = run({"figure", "out", "mac"});
  EXPECT_EQ(done.status, 3);
  EXPECT_TRUE(says(done.err, "it is of Chladni 0.0.1"));
  leave_comparison("old", "0.0.1+g1");  // the same data are drawn
  EXPECT_EQ(run({"figure", "old", "--format", "svg"}).status, 0);
  write("out/comparison.json", R"({"modes": []})");
  EXPECT_TRUE(says(run({"figure", "out", "mac"}).err, "it does not state which Chladni wrote it"));
}

// Another run leaves no diagram either.
TEST_F(FigureVerb, TheVersionIsNoReasonWhereNothingWasAskedFor) {
  fs::create_directories(folder_ / "out");
  write("out/identified.json", R"({"chladni": "0.0.1+g1", "modes": [], "stabilisation": []})");
  const auto done = run({"figure", "out", "stabilisation"});
  EXPECT_EQ(done.status, 3);
  EXPECT_TRUE(says(done.err, "no diagram was made"));
  EXPECT_FALSE(says(done.err, "it is of Chladni"));
}

}  // namespace
}  // namespace chladni::app
