// chladni priors: what it learns of bodies whose shapes are known, what it leaves, what it refuses.
#include "steps/priors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>
#include <variant>

#include "base/error.h"
#include "io/json.h"
#include "priors/learning.h"
#include "show/priors.h"
#include "tests/app/quiet_run.h"

namespace chladni::steps {
namespace {

const std::string kPlate = R"(title = "square plate"
geometry = { plate = { length = "600 mm", width = "600 mm", thickness = "20 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "40 mm", order = 2 }
modes = { count = 12, damping_ratio = 0.005 }
)";
const std::string kChannels = R"(
[[sensor]]
name = "s1"
at = ["-250 mm", "210 mm"]
direction = "z"
[[sensor]]
name = "s2"
at = ["240 mm", "190 mm"]
direction = "z"
[[sensor]]
name = "s3"
at = ["200 mm", "-100 mm"]
direction = "z"
[[actuator]]
name = "a1"
at = ["-110 mm", "-230 mm"]
direction = "z"
[[actuator]]
name = "a2"
at = ["-20 mm", "30 mm"]
direction = "z"
)";

class Priors : public ::testing::Test {
 protected:
  study::Study study_with(const std::string& priors, const std::string& rest = "") const {
    return study::parse_study(kPlate + rest + "[priors]\n" + priors, folder_.path() / "study.toml");
  }

  steps::LearnedPriors learned_with(const std::string& priors, const std::string& rest = "") {
    const study::Study study = study_with(priors, rest);
    app::QuietRun quiet(study, folder_.path() / "out");
    auto& run = quiet.run();
    const stage::Solution solution = stage::solved(study, run);
    auto result = steps::learned_priors(study, solution, run);
    table_ = show::priors_table(solution, result);
    run.leave("priors.json", show::priors_json(solution, result), true);
    return result;
  }

  void refused(const std::string& priors, const std::string& word) {
    try {
      (void)learned_with(priors);
      ADD_FAILURE() << "taken; expected a refusal about " << word;
    } catch (const InvalidInput& e) {
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
    }
  }

  io::Json left() const {
    std::ifstream stream(folder_.path() / "out" / "priors.json");
    std::ostringstream text;
    text << stream.rdbuf();
    return io::parse_json(text.str());
  }

  app::TestFolder folder_{"priors"};
  std::string table_;
};

TEST_F(Priors, LengthsFallAsModesGetMoreComplex) {
  const auto found = learned_with("samples = [100, 200]");
  const auto& modes = found.last().per_mode;
  ASSERT_EQ(modes.size(), 12U);
  EXPECT_LT(modes[11].parameters(0), 0.8 * modes[0].parameters(0));
  EXPECT_GT(found.most_complex, 7);
  for (const auto& one : modes) {
    EXPECT_GT(one.parameters(0), 0.05);
    EXPECT_LT(one.parameters(0), 0.5);
  }
  // Between the shortest and the longest of them.
  EXPECT_LT(found.last().shared.parameters(0), modes[0].parameters(0));
}

// The plate's repeated modes are each other's image.
TEST_F(Priors, RepeatedModesHaveOneLength) {
  const auto found = learned_with("samples = [400]\nmodes = 7");
  const auto& modes = found.last().per_mode;
  EXPECT_NEAR(modes[3].parameters(0) / modes[4].parameters(0), 1.0, 0.02);
  EXPECT_NEAR(modes[5].parameters(0) / modes[6].parameters(0), 1.0, 0.02);
}

TEST_F(Priors, SaysTheRidgeInItsHeading) {
  const auto found = learned_with("samples = [200]\nmodes = 4");
  EXPECT_GT(found.last().noise_dependence.maxCoeff(), 0.05);
  EXPECT_TRUE(table_.starts_with("! on the ridge of sigma and length")) << table_;
  const auto noisy = learned_with("samples = [200]\nmodes = 4\nnoise_ratio = \"learned\"");
  EXPECT_EQ(noisy.last().noise_dependence.maxCoeff(), 0.0);
}

TEST_F(Priors, SaysWhatIsAtItsBound) {
  (void)learned_with("samples = [9]");  // too few for the last modes
  EXPECT_NE(table_.find("at the end of their range"), std::string::npos) << table_;
}

// The first mode, x y, looks the same along x and along y.
TEST_F(Priors, LearnsALengthPerAxis) {
  const auto found = learned_with("samples = [200]\nmodes = 1\naxes = \"per_axis\"");
  const auto& lengths = found.last().per_mode[0].parameters;
  ASSERT_EQ(lengths.size(), 3);
  EXPECT_NEAR(lengths(0) / lengths(1), 1.0, 0.05);
}

TEST_F(Priors, LeavesTheKeysOfTheContract) {
  (void)learned_with(
      "samples = [50, 100]\nmodes = 3\nkernel = \"matern_5_2\"\nby = \"leave_one_out\"", kChannels);
  const auto json = left();
  const auto& one = json.at("modes").array().at(2);
  for (const auto* key : {"length_scale_m", "sigma", "noise", "log_marginal_likelihood", "samples",
                          "frequency_hz", "matched_length_m", "expected_error"}) {
    EXPECT_TRUE(std::isfinite(one.at(key).number())) << key;
  }
  EXPECT_EQ(json.at("by").string(), "leave_one_out");
  EXPECT_EQ(one.at("kernel").string(), "matern_5_2");
  EXPECT_EQ(one.at("mode").number(), 3.0);
  EXPECT_EQ(json.at("shared").at("samples").number(), 100.0);
  EXPECT_EQ(json.at("by_samples").array().size(), 2U);
  EXPECT_EQ(json.at("by_samples").array().at(0).at("modes").array().size(), 3U);
}

TEST_F(Priors, MatchesTheLengthToTheChannels) {
  const auto with = learned_with("samples = [200]\nmodes = 6", kChannels);
  ASSERT_EQ(with.matched_length.size(), 6);
  EXPECT_GT(with.matched_length(0), with.last().per_mode[0].parameters(0));
  EXPECT_LT(with.expected_error(0), with.expected_error(5));  // five places see six modes badly
  EXPECT_EQ(learned_with("samples = [50]\nmodes = 1").matched_length.size(), 0);
}

// Two places do not resolve twelve modes: no length lets them, and the shortest one is no finding.
TEST_F(Priors, SaysWhichMatchedLengthsAreNone) {
  const auto third = kChannels.find("[[sensor]]\nname = \"s3\"");
  const auto two = learned_with("samples = [50]", kChannels.substr(0, third));
  Points places(2, 3);
  places << -0.25, 0.21, 0.01, 0.24, 0.19, 0.01;
  const auto [low, high] = priors::length_range(places);
  const auto json = left();
  int none = 0;
  for (Eigen::Index i = 0; i < two.matched_length.size(); ++i) {
    const double length = two.matched_length(i);
    const bool at_bound = length < 1.001 * low || length > 0.999 * high;
    none += at_bound ? 1 : 0;
    const auto& one = json.at("modes").array().at(static_cast<std::size_t>(i));
    EXPECT_EQ(std::get<bool>(one.at("matched_at_bound").value()), at_bound)
        << i << ", " << length << " m";
  }
  EXPECT_GT(none, 0);
  EXPECT_NE(table_.find("! matched lengths at the end of their range: "), std::string::npos)
      << table_;
  (void)learned_with("samples = [50]\nmodes = 2", kChannels);
  EXPECT_EQ(table_.find("matched lengths at the end"), std::string::npos) << table_;
}

TEST_F(Priors, TakesNoMoreSamplesThanThereAre) {
  const auto found = learned_with("samples = [4, 50, 4000, 3900]\nmodes = 1\nnoise_ratio = 1e-6");
  EXPECT_EQ(found.by_samples.size(), 3U);
  EXPECT_LT(found.last().samples, 3900);
  ASSERT_FALSE(found.notes.empty());
  EXPECT_NE(found.notes[0].find("cannot be had"), std::string::npos);
}

TEST_F(Priors, OfSeveralPatchesAreLearnedAlongOneDirection) {
  const auto top = learned_with("samples = [60]\nmodes = 2\non = [\"top\"]");
  const auto both =
      learned_with("samples = [60]\nmodes = 2\non = [\"top\", \"bottom\"]\ndirection = \"z\"");
  for (std::size_t i = 0; i < 2; ++i) {
    const double ratio =
        both.last().per_mode[i].parameters(0) / top.last().per_mode[i].parameters(0);
    EXPECT_NEAR(std::log(ratio), 0.0, 1.0) << "the two sides of a thin plate move alike";
  }
}

TEST_F(Priors, RefusesWhatCannotBeMeant) {
  refused("kernel = \"matern\"", "matern_5_2");
  refused("samples = [1]", "4 to 4000");
  refused("samples = [100000]", "4 to 4000");
  refused("samples = \"many\"", "4 to 4000");
  refused("samples = []", "4 to 4000");
  refused("noise_ratio = 1e-12", "1e-8");
  refused("modes = 40", "flexible mode 40, but 12 will be computed");
  refused("on = [\"lid\"]", "lid");
  refused("on = [\"top\", \"x_max\"]", "\"top\" and \"x_max\" look 90 degrees apart");
  refused("on = [\"top\", \"bottom\"]", "direction = \"z\" for the motion along one axis");
  refused("by = \"luck\"", "leave_one_out");
  refused("smaples = [10]", "samples");
}

}  // namespace
}  // namespace chladni::steps
