// chladni place: what it finds on bodies with known answers, what it leaves, what it refuses.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/error.h"
#include "io/json.h"
#include "show/placement.h"
#include "steps/placement.h"
#include "tests/refusal.h"
#include "tests/steps/placed_plate.h"

namespace chladni::steps {
namespace {

// The eight places that the plate's symmetry makes of one, to 1 %.
TEST_F(Place, FindsTheThesissPlacesOnTheSquarePlate) {
  const auto placed = placed_with("modes = 3");
  ASSERT_GE(placed.best.size(), 8U);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_NEAR(placed.best[i].score, 0.548, 0.01);
    EXPECT_NEAR(placed.best[i].score / placed.best[0].score, 1.0, 0.01);
    const Eigen::Array2d at = placed.best[i].position.head<2>().cwiseAbs();
    EXPECT_NEAR(at.maxCoeff(), 0.3, 1e-6);
    EXPECT_NEAR(at.minCoeff(), 0.185, 0.004);
  }
}

TEST_F(Place, LeavesTheKeysOfTheContract) {
  (void)placed_with("modes = 3");
  const auto json = left();
  EXPECT_EQ(json.at("criterion").string(), "weakest_mode");
  const auto& best = json.at("best").array().at(0);
  for (const auto* key : {"x_m", "y_m", "z_m", "score", "limiting_mode"}) {
    EXPECT_TRUE(std::isfinite(best.at(key).number())) << key;
  }
  const auto& layout = json.at("layouts").array().at(0);
  EXPECT_EQ(layout.at("sensors").array().size(), 3U);
  EXPECT_EQ(layout.at("scores").at("observed_points").number(), 5.0);  // 3 + 3 - 1
  const auto& optimum = json.at("optimum");
  EXPECT_EQ(optimum.at("sites").array().size(), 5U);
  EXPECT_GE(optimum.at("bound").number(), optimum.at("score").number());
  EXPECT_NEAR(optimum.at("gap").number(),
              optimum.at("bound").number() - optimum.at("score").number(), 1e-12);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out" / "heat_map.vtu"));
}

// s3 and a1 are one point of five.
TEST_F(Place, APairThatStaysTakesOneSite) {
  for (const auto* there : {"[\"s3\", \"a1\"]", "[\"s3\"]", "[\"s1\"]"}) {
    const auto placed = placed_with(std::string("modes = 3\nthere = ") + there);
    ASSERT_FALSE(placed.optima.empty());
    EXPECT_EQ(placed.optima[0].sites.rows(), 4) << there;
  }
}

TEST_F(Place, ABestLayoutIsToldWithTheChannelsThatStay) {
  const auto placed = placed_with("modes = 3\nthere = [\"s3\", \"a1\"]");
  ASSERT_EQ(placed.layouts.size(), 3U);
  for (const auto* layout : {&placed.layouts[1], &placed.layouts[2]}) {
    EXPECT_EQ(layout->sensors, std::vector<std::string>{"s3"});
    EXPECT_EQ(layout->actuators, std::vector<std::string>{"a1"});
    EXPECT_EQ(layout->markers.size(), 2U + 4U);  // two stay, four are chosen
  }
}

TEST_F(Place, AnErrorOfThePositionIsInTheAlphaOfALayout) {
  const auto alpha = [&](const std::string& error) {
    (void)placed_with("modes = 3" + error);
    return left().at("layouts").array().at(0).at("scores").at("pair_alpha").number();
  };
  EXPECT_GT(alpha("\nposition_error = \"5 mm\""), 1.05 * alpha(""));
}

TEST_F(Place, APairOfModesIsLookedAtWhole) {
  const auto placed = placed_with("modes = [4]");
  EXPECT_EQ(placed.wanted.columns.size(), 2U);
  ASSERT_EQ(placed.notes.size(), 1U);
  EXPECT_TRUE(says(placed.notes[0], "together with it"));
}

TEST_F(Place, SaysThatModesAreAboveThoseComputed) {
  EXPECT_TRUE(says(placed_with("up_to = \"9 kHz\"").notes.at(0), "above it are not looked at"));
}

// Three springs hold it along z: its first three modes above 0 Hz are those of a rigid body.
TEST_F(Place, SaysThatModesAreOfTheSuspension) {
  std::string springs;
  for (const char* at :
       {R"("-250 mm", "-250 mm")", R"("250 mm", "-250 mm")", R"("0 mm", "250 mm")"}) {
    springs += fmt::format(
        "[[attachment]]\nkind = \"spring\"\nname = \"cord {}\"\nstiffness = \"500 N/m\"\n"
        "direction = \"z\"\nat = [{}]\n",
        springs.size(), at);
  }
  const auto placed = placed_with("modes = 3\n" + springs);
  ASSERT_EQ(placed.notes.size(), 1U);
  EXPECT_TRUE(says(placed.notes[0], "the body moves on its springs"));
  EXPECT_TRUE(says(placed.notes[0], "placement.modes = [4, 5, 6]"));
  EXPECT_TRUE(placed_with("modes = [4, 5]\n" + springs).notes.empty());
}

TEST_F(Place, AGridGivesItsPlacesAndAProvenOptimum) {
  const auto placed = placed_with(
      "modes = 5\ngrid = { pitch = \"60 mm\", columns = 9, rows = 9 }\n"
      "choose = { sites = 7 }");
  for (const auto& pair : placed.best) {
    for (const double x : {pair.position.x(), pair.position.y()}) {
      EXPECT_NEAR(std::remainder(x, 0.06), 0.0, 1e-9);
      EXPECT_LE(std::abs(x), 0.2401);
    }
  }
  EXPECT_TRUE(placed.optima[0].choice.proven);
  EXPECT_EQ(placed.optima[0].sites.rows(), 7);
  EXPECT_FALSE(placed.optima[0].equivalent.empty());
}

TEST_F(Place, KeepsToItsRules) {
  const auto placed = placed_with(
      "modes = 3\nedge_distance = \"50 mm\"\nfootprint = \"30 mm\"\npairs = 3\n"
      "spacing = \"150 mm\"\n"
      "keep_out = [{ disc = { at = [\"200 mm\", \"200 mm\"], diameter = \"200 mm\" } }]");
  ASSERT_EQ(placed.pairs.size(), 3U);
  for (const auto* pairs : {&placed.best, &placed.pairs}) {
    for (const auto& pair : *pairs) {
      const Eigen::Vector2d at = pair.position.head<2>();
      EXPECT_LE(at.cwiseAbs().maxCoeff(), 0.2501);
      EXPECT_GT((at - Eigen::Vector2d(0.2, 0.2)).norm(), 0.0999);
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GE((placed.pairs[i].position - placed.pairs[j].position).norm(), 0.1499);
    }
  }
}

TEST_F(Place, AnUncertainBodyScoresNoHigherAndMovesAwayFromNodalLines) {
  const auto sure = placed_with("modes = 3");
  const auto unsure = placed_with(
      "modes = 3\nuncertainty = { modulus = \"10 %\", thickness = \"5 %\", "
      "attached_mass = \"0.3 kg\", members = 16 }");
  const auto& before = sure.maps[sure.chosen].score;
  const auto& after = unsure.maps[unsure.chosen].score;
  EXPECT_LE((after - before).maxCoeff(), 0.02 * before.maxCoeff());
  EXPECT_LT(after.maxCoeff(), before.maxCoeff());
  EXPECT_GT(after.maxCoeff(), 0.3 * before.maxCoeff());
}

TEST_F(Place, NoiseOfFrfsMakesHighModesLimit) {
  const auto placed = placed_with(
      "modes = 9\ncriterion = \"alpha_uncertainty\"\nfrf_noise = \"1e-9 m/N\"\n"
      "frequency_resolution = \"0.5 Hz\"\nposition_error = \"0.2 mm\"");
  const Eigen::VectorXd noise = placed.wanted.sensor_noise.cwiseQuotient(placed.wanted.rms);
  EXPECT_GT(noise.tail<1>()(0), 5.0 * noise(0));
  const double percent = placed.criterion->for_people(placed.best[0].score);
  EXPECT_GT(percent, 0.0);
  EXPECT_LT(percent, 100.0);
}

TEST_F(Place, NamesTheModeThatALayoutCannotSee) {
  (void)placed_with("modes = 9\non = [\"top\"]");
  const auto text = shown_.str();
  EXPECT_TRUE(says(text, "best places"));
  const study::Study study = study::parse_study(
      kPlate + "[[layout]]\nname = \"diagonal\"\nsensors = [\"s1\", \"s2\"]\n", "study.toml");
  show::Options options;
  options.folder = folder_ / "out2";
  options.pictures = false;
  show::Talk talk(said_, show::manner_of_stderr(false));
  show::Run run(study, options, shown_, talk);
  const auto solution = stage::solved(study, run);
  const auto result = steps::best_places(study, solution, run);
  show::leave_placement(study, solution, result, run, true);
  ASSERT_FALSE(result.layouts[0].blind.empty());
  EXPECT_EQ(result.layouts[0].blind[0], 8);  // x^2 - y^2 vanishes on the diagonals
  EXPECT_TRUE(says(said_.str(), "layout \"diagonal\" cannot see modes 8 (26"));
}

// The best layouts were along z without a word, beside a study whose channels go in x and y.
TEST_F(Place, SaysThatChannelsPointElsewhere) {
  const auto notes_of = [&](const std::string& direction) {
    std::string text = kPlate;
    text.replace(
        text.find("{ name = \"s2\""), 0,
        "{ name = \"side\", at = [\"300 mm\", \"0 mm\", \"-10 mm\"], direction = \"x\" },\n  ");
    const auto study =
        study::parse_study(text + "[placement]\nmodes = [1]\n" + direction, "study.toml");
    stage::Work work;
    return steps::best_places(study, stage::solved(study, work), work).notes;
  };
  const auto told = [](const auto& notes) { return fmt::format("{}", fmt::join(notes, "\n")); };
  const auto open = told(notes_of(""));
  EXPECT_TRUE(says(open, "the surface's normal, and \"side\" of the study points elsewhere"));
  EXPECT_TRUE(says(open, "placement.direction"));
  EXPECT_FALSE(says(told(notes_of("direction = \"z\"\n")), "elsewhere"));
}

TEST_F(Place, SaysThatTwoSensorsAreInOnePlace) {
  std::string text = kPlate;
  const std::string at = "at = [\"250 mm\", \"250 mm\"]";
  text.replace(text.find(at), at.size(), "at = [\"-250 mm\", \"250 mm\"]");
  const study::Study study = study::parse_study(text, "study.toml");
  show::Options options;
  options.folder = folder_ / "out";
  options.pictures = false;
  show::Talk talk(said_, show::manner_of_stderr(true));
  show::Run run(study, options, shown_, talk);
  const auto solution = stage::solved(study, run);
  const auto result = steps::best_places(study, solution, run);
  ASSERT_EQ(result.notes.size(), 1U);
  EXPECT_TRUE(says(result.notes[0], "sensors s1 and s2 are in one place"));
}

const std::string kAmplifier = R"(
[observer]
noise = "0.5 nm"
sample_rate = "10 kHz"
[[observer.disturbance]]
name = "amplifier"
kind = "actuators"
rms = "20 mN"
)";
const std::string kFewPlaces = "modes = 3\ngrid = { pitch = \"120 mm\", columns = 5, rows = 5 }\n";

TEST_F(Place, ChoosesSensorsForAnObserver) {
  const auto placed = placed_with(
      kFewPlaces + "choose = { sites = 3, by = \"observer\" }\n[placement.observer]\n" +
      "region = [{ disc = { at = [\"60 mm\", \"-60 mm\"], diameter = \"150 mm\" } }]\n" +
      "suspension = \"5 Hz\"\n" + kAmplifier);
  ASSERT_EQ(placed.optima.size(), 3U);
  const auto& best = placed.optima[0];
  EXPECT_EQ(best.by, "observer_error");
  ASSERT_EQ(best.sites.rows(), 3);
  ASSERT_TRUE(best.observer.has_value());
  EXPECT_DOUBLE_EQ(best.choice.score, -best.observer->estimate);
  EXPECT_TRUE(says(best.remark, "no bound is known; no exchange of one device gains"));
  for (const auto& layout : placed.layouts) {
    ASSERT_TRUE(layout.observer.has_value()) << layout.name;
    EXPECT_EQ(layout.motion_deviation.size(), placed.surface.sites.count());
    if (layout.name == "study") continue;  // its sensors are elsewhere
    EXPECT_GE(layout.observer->estimate, best.observer->estimate * (1.0 - 1e-6)) << layout.name;
  }
  EXPECT_TRUE(says(shown_.str(), "best 3 sensors by observer_error: its motion is known to"));
  ASSERT_EQ(placed.notes.size(), 1U);
  EXPECT_TRUE(says(placed.notes[0], "6 rigid-body modes without stiffness are held at 5 Hz"));
  const auto json = left();
  const auto& optimum = json.at("optimum");
  EXPECT_EQ(optimum.at("devices").array().at(2).string(), "sensor");
  const double known = optimum.at("observer").at("estimate_m").number();
  EXPECT_NEAR(known * known, best.observer->estimate, 1e-9 * best.observer->estimate);
  EXPECT_LT(known, optimum.at("observer").at("without_m").number());
}

TEST_F(Place, ChoosesPairsAndSensorsTogetherForALoop) {
  const auto placed = placed_with(kFewPlaces + "[placement.observer]\nsensors = 1\npairs = 1\n" +
                                  "effort = \"10 nm/N\"\nsuspension = \"5 Hz\"\n" + kAmplifier);
  ASSERT_EQ(placed.optima.size(), 3U);
  EXPECT_EQ(placed.optima[0].by, "determinant");
  const auto& best = placed.optima[2];
  EXPECT_EQ(best.by, "loop_cost");
  using enum placement::DeviceKind;
  EXPECT_EQ(best.kinds, (std::vector<placement::DeviceKind>{pair, sensor}));
  EXPECT_EQ(best.sensing().rows(), 2);
  EXPECT_EQ(best.acting().rows(), 1);
  EXPECT_NEAR(best.observer->loop,
              best.observer->loop_motion + 1e-16 * best.observer->loop_force_n2,
              1e-5 * best.observer->loop);
  const auto& layout = placed.layouts.back();
  EXPECT_EQ(layout.name, "best by loop_cost");
  EXPECT_EQ(layout.markers.size(), 3U);
  EXPECT_NEAR(layout.observer->loop, best.observer->loop, 1e-6 * best.observer->loop);
  EXPECT_TRUE(
      says(shown_.str(), "best 1 pair, 1 sensor by loop_cost: in the loop the region moves"));
}

// A free plate follows the floor through its suspension as one mass: variance S / (4 ζ ω³) for a
// two-sided density S of the acceleration, relative to the floor.
TEST_F(Place, TheFloorMovesAFreePlateAsAWhole) {
  const std::string floor = R"(
[observer]
noise = "0.5 nm"
sample_rate = "10 kHz"
[[observer.disturbance]]
name = "floor"
kind = "floor"
density = "2e-10 m^2 s^-4/Hz"
)";
  const auto placed =
      placed_with(kFewPlaces +
                  "choose = { sites = 1 }\n[placement.observer]\nsuspension = \"20 Hz\"\n" + floor);
  const double omega = 2.0 * 3.14159265358979 * 20.0;
  const double expected = 1e-10 / (4.0 * 0.7 * std::pow(omega, 3));
  EXPECT_NEAR(placed.optima[2].observer->without, expected, 0.01 * expected);
}

TEST_F(Place, RefusesAnObserverThatIsNotStated) {
  const auto without = [](const std::string& line) {
    std::string text = kAmplifier;
    text.erase(text.find(line), line.size());
    return "modes = 3\nchoose = { sites = 2, by = \"observer\" }\n" + text;
  };
  EXPECT_TRUE(
      says(refusal("modes = 3\nchoose = { by = \"observer\" }"),
           "study.toml: a layout for an observer needs to know what disturbs the body, and no "
           "disturbance is stated; expected [observer]"));
  EXPECT_TRUE(says(refusal(without("noise = \"0.5 nm\"\n")),
                   "needs the noise of the sensors, which is not stated; expected observer.noise"));
  EXPECT_TRUE(
      says(refusal(without("sample_rate = \"10 kHz\"\n")), "expected observer.sample_rate"));
  const std::string start = "modes = 3\n[placement.observer]\n";
  EXPECT_TRUE(says(refusal(start +
                           "region = [{ disc = { at = [\"2 m\", \"0 m\"], diameter = \"1 mm\" } "
                           "}]\n" +
                           kAmplifier),
                   "placement.observer.region has no point of the faces"));
  EXPECT_TRUE(
      says(refusal(start + "region = [\"lid\"]\n" + kAmplifier), "the body has no patch \"lid\""));
  EXPECT_TRUE(
      says(refusal(start + "suspension = \"900 Hz\"\n" + kAmplifier),
           "held at 900 Hz; expected a frequency above 0 and below the first flexible mode"));
  EXPECT_TRUE(says(refusal(start + "pairs = 2\n" + kAmplifier), "effort"));
}

TEST_F(Place, RefusesWhatCannotBeMeant) {
  EXPECT_TRUE(says(refusal("modes = 40"), "asks for flexible mode 40, but"));
  EXPECT_TRUE(says(refusal("up_to = \"20 Hz\""), "first flexible mode lies at"));
  EXPECT_TRUE(says(refusal("modes = 3\nkeep_out = [\"top\"]"), "no admissible site is left of"));
  EXPECT_TRUE(says(refusal("modes = 3\nkeep_out = [\"lid\"]"), "the body has no patch \"lid\""));
  EXPECT_TRUE(says(refusal("modes = 3\non = [\"lid\"]"), "the body has no patch \"lid\""));
  EXPECT_TRUE(says(refusal("modes = 3\nedge_distance = \"400 mm\""),
                   "the last ones went to the distance of 400 mm from edges"));
  EXPECT_TRUE(says(refusal("modes = 3\ngrid = { pitch = \"60 mm\", columns = 2, rows = 2 }\n"
                           "choose = { sites = 9 }"),
                   "9 sites are to be chosen, but 4 are admissible"));
  EXPECT_TRUE(says(refusal("modes = 3\ngrid = { pitch = \"60 mm\", columns = 2, rows = 2, "
                           "centre = [\"2 m\", \"0 m\"] }"),
                   "none of its places lies on the body"));
  EXPECT_TRUE(says(refusal("modes = 0"), "placement.modes"));
  EXPECT_TRUE(says(refusal("modes = 3\nspacing = \"500 mm\"\npairs = 9"), "do not fit"));
  EXPECT_TRUE(says(refusal("modes = 3\nthere = [\"s9\"]"), "no channel of the study"));
  EXPECT_TRUE(says(refusal("modes = 3\ncriterion = \"weakest\""), "weakest_mode"));
  EXPECT_TRUE(says(refusal("modes = 3\nnoise = \"0 %\""), "expected more than 0"));
  EXPECT_TRUE(says(refusal("modes = 3\nfrf_noise = \"1e-9 m/N\""), "frequency_resolution"));
}

}  // namespace
}  // namespace chladni::steps
