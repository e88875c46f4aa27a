// chladni interpolate: what it makes of a body that its model does not know, and what it refuses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "io/json.h"
#include "io/shape_table.h"
#include "show/interpolation.h"
#include "steps/interpolation.h"
#include "steps/predicted.h"
#include "tests/app/quiet_run.h"

namespace chladni::steps {
namespace {

namespace fs = std::filesystem;

const std::string kBody =
    R"(material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "60 mm", order = 2 }
modes = { count = 16, damping_ratio = 0.005 }
)";
const std::string kPlate =
    "geometry = { plate = { length = \"600 mm\", width = \"500 mm\", thickness = \"20 mm\" } }\n" +
    kBody;
// Thicker, with a mass on a corner.
const std::string kReal =
    "geometry = { plate = { length = \"600 mm\", width = \"500 mm\", thickness = \"22 mm\" } }\n" +
    kBody + R"([[attachment]]
kind = "mass"
name = "bracket"
at = ["250 mm", "200 mm"]
mass = "0.5 kg"
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
[[sensor]]
name = "s4"
at = ["-110 mm", "-230 mm"]
direction = "z"
[[sensor]]
name = "s5"
at = ["30 mm", "20 mm"]
direction = "z"
[[actuator]]
name = "a1"
at = ["-270 mm", "-60 mm"]
direction = "z"
[[actuator]]
name = "a2"
at = ["20 mm", "230 mm"]
direction = "z"
[[actuator]]
name = "a3"
at = ["280 mm", "-240 mm"]
direction = "z"
)";

class Interpolate : public ::testing::Test {
 protected:
  void SetUp() override { write("real.toml", kReal); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
  }

  steps::Interpolated interpolated_with(const std::string& parts) {
    const study::Study study =
        study::parse_study(kPlate + kChannels + parts, folder_.path() / "study.toml");
    app::QuietRun quiet(study, folder_.path() / "out");
    auto& run = quiet.run();
    const stage::Solution solution = stage::solved(study, run);
    auto result = steps::interpolated(study, solution, run);
    run.show(show::interpolation_table(result));
    show::leave_interpolation(study, solution, result, run, true);
    said_ = quiet.said();
    return result;
  }

  void refused(const std::string& parts, const std::string& word) {
    try {
      (void)interpolated_with(parts);
      ADD_FAILURE() << "taken; expected a refusal about " << word;
    } catch (const InvalidInput& e) {
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
    }
  }

  io::Json json(const std::string& name) const {
    std::ifstream stream(folder_.path() / "out" / name);
    std::ostringstream text;
    text << stream.rdbuf();
    return io::parse_json(text.str());
  }

  // The numbers of a table that was left, without its head.
  std::vector<std::vector<double>> rows_of(const std::string& name) const {
    std::ifstream stream(folder_.path() / "out" / name);
    std::vector<std::vector<double>> rows;
    std::string line;
    std::getline(stream, line);
    while (std::getline(stream, line)) {
      auto& row = rows.emplace_back();
      std::istringstream cells(line);
      for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    }
    return rows;
  }

  std::string said_;  // by the last run
  app::TestFolder folder_{"interpolate"};
};

const std::string kTruth = "[measurement]\ntruth = \"real.toml\"\nmodes = 6\n";

TEST_F(Interpolate, KnowsTheWholeShapeOfABodyThatTheModelDoesNotKnow) {
  const auto result = interpolated_with(kTruth + "hold_out = [\"s5\"]\n");
  const auto& ours = result.methods.front();
  EXPECT_STREQ(ours.method->name, "dynamic_residual");
  EXPECT_LT(ours.error.head(4).maxCoeff(), 0.02);
  EXPECT_LT(ours.hidden_error(0), 0.2);
  EXPECT_GT(ours.covered.mean(), 0.85);
  for (const auto& other : result.methods) EXPECT_LE(ours.error.mean(), other.error.mean());
}

TEST_F(Interpolate, LeavesTheKeysOfTheContract) {
  (void)interpolated_with(kTruth +
                          "hold_out = [\"s5\", \"a2\"]\n[interpolation]\nmethods = "
                          "[\"dynamic_residual\"]\npoint = [{ name = \"tip\", at = [\"0 mm\", "
                          "\"0 mm\"] }]\n");
  const auto left = json("interpolation.json");
  EXPECT_EQ(left.at("held_out").array().size(), 2U);
  const auto& method = left.at("methods").array().at(0);
  EXPECT_EQ(method.at("method").string(), "dynamic_residual");
  const auto& channel = method.at("held_out").array().at(1);
  EXPECT_EQ(channel.at("channel").string(), "a2");
  EXPECT_LT(channel.at("frf_error").number(), 0.5);
  EXPECT_LT(channel.at("shape_error").number(), 0.5);
  EXPECT_GE(channel.at("coverage").number(), 0.5);
  EXPECT_EQ(method.at("points").array().at(0).at("mean").array().size(), 6U);
  EXPECT_EQ(method.at("surface").at("squared_error").array().size(), 6U);
  EXPECT_TRUE(fs::exists(folder_.path() / "out" / "mode_field.vtu"));
}

// The scale between sensors and actuators is not known where nothing is measured either.
TEST_F(Interpolate, TheWholeSurfaceHasTheDeviationOfTheScale) {
  auto result = interpolated_with(kTruth + "[interpolation]\nmethods = [\"thin_plate_spline\"]\n");
  const auto& certain = result.methods.front();
  const auto count = result.measured.shapes.mode_count();
  auto model = std::make_shared<IdentifiedModel>();
  for (Eigen::Index k = 0; k < count; ++k) {
    model->match.modes.push_back({.alpha = 1.0, .alpha_std = 0.2});
    result.measured.fitted_mode.push_back(k);
  }
  result.measured.identified = model;
  auto& sides = result.measured.shapes.sides.emplace();
  for (const auto& channel : result.measured.channels) sides.actuator.push_back(channel[0] == 'a');
  sides.log_deviation = Eigen::VectorXd::Constant(count, 0.2);
  sides.noise = result.measured.shapes.noise;
  const auto one = interpolated_by(*certain.method, result);
  EXPECT_EQ(one.surface.deviation, field_at(one, result.simulation.surface).deviation);
  const auto without = one.field->at(result.simulation.surface).deviation;
  EXPECT_TRUE((one.surface.deviation.array() >= without.array()).all());
  EXPECT_GT(one.surface.deviation.norm(), 1.01 * without.norm());
  EXPECT_EQ(one.surface.mean, certain.surface.mean);
}

// No deviation of a held-out channel is known: how often it holds the value is not 0 %.
TEST_F(Interpolate, AChannelOfUnknownNoiseIsCoveredUnknownOften) {
  auto result = interpolated_with(kTruth + "hold_out = [\"s5\"]\n");
  for (const double unknown : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    result.measured.hidden.noise.setConstant(unknown);
    const auto one = interpolated_by(*result.methods.front().method, result);
    EXPECT_TRUE(std::isnan(one.hidden_covered(0))) << unknown;
  }
}

TEST_F(Interpolate, ATableOfShapesGivesWhatTheTruthGave) {
  const auto virtually = interpolated_with(kTruth);
  const auto& measured = virtually.measured;
  io::write_shapes(folder_.path() / "shapes.csv",
                   {measured.channels, measured.shapes.frequency_hz, measured.damping_ratio,
                    measured.shapes.values, measured.shapes.noise});
  const auto read = interpolated_with("[measurement]\nshapes = \"shapes.csv\"\n");
  EXPECT_EQ(read.methods.front().surface.mean, virtually.methods.front().surface.mean);
  EXPECT_EQ(read.measured.truth.size(), 0);
}

// An empty cell is no measured 0: the channel or the mode that lacks the value takes no part.
TEST_F(Interpolate, EmptyCellsOfATableOfShapesAreNotKnown) {
  const auto whole = interpolated_with(kTruth).measured;
  const auto count = whole.shapes.mode_count();
  io::ShapeTable table{whole.channels, whole.shapes.frequency_hz, whole.damping_ratio,
                       whole.shapes.values, whole.shapes.noise};
  const auto empty = [&](Eigen::Index row, Eigen::Index mode) {
    table.values(row, mode) = std::nan("");
    table.deviation(row, mode) = std::numeric_limits<double>::infinity();
  };
  for (Eigen::Index i = 0; i < count; ++i) empty(4, i);
  empty(1, 2);
  io::write_shapes(folder_.path() / "shapes.csv", table);
  const auto read = interpolated_with("[measurement]\nshapes = \"shapes.csv\"\n").measured;
  ASSERT_EQ(read.shapes.mode_count(), count - 1);
  ASSERT_EQ(read.channels.size(), whole.channels.size() - 1);
  EXPECT_EQ(read.channels[4], whole.channels[5]);
  EXPECT_EQ(read.shapes.frequency_hz(2), whole.shapes.frequency_hz(3));
  EXPECT_EQ(read.shapes.values(4, 2), whole.shapes.values(5, 3));
  EXPECT_EQ(read.shapes.noise(4, 2), whole.shapes.noise(5, 3));
  EXPECT_NE(said_.find("not known (empty cells): " + std::to_string(count + 1) + ";"),
            std::string::npos)
      << said_;
  empty(0, 0);
  for (Eigen::Index i = 1; i < count; ++i) empty(2, i);
  io::write_shapes(folder_.path() / "shapes.csv", table);
  refused("[measurement]\nshapes = \"shapes.csv\"\n", "no mode has a value at each channel");
}

TEST_F(Interpolate, LeavesATableAndPolynomialsForAController) {
  const auto result = interpolated_with(
      kTruth + "[interpolation]\ntable_pitch = \"100 mm\"\npolynomial_degree = 8\n");
  std::ifstream stream(folder_.path() / "out" / "mode_field.csv");
  std::string head;
  std::getline(stream, head);
  EXPECT_EQ(head.substr(0, 28), "x_m,y_m,z_m,mean_1,std_1,mea");
  int lines = 0;
  for (std::string line; std::getline(stream, line);) ++lines;
  EXPECT_EQ(lines, 7 * 6);
  const auto left = json("mode_field_polynomial.json");
  EXPECT_EQ(left.at("coefficients").array().size(), 6U);
  EXPECT_LT(left.at("rms_error").array().at(0).number(), 0.01);
}

// The table was on the top of the body, whatever faces were named. A thin plate moves along z by
// the same amount above and below.
TEST_F(Interpolate, ATableLiesOnTheFacesThatAreNamed) {
  const auto table_on = [&](const std::string& patch) {
    (void)interpolated_with(kTruth +
                            "[interpolation]\nmethods = [\"dynamic_residual\"]\ndirection = "
                            "\"z\"\ntable_pitch = \"100 mm\"\non = [\"" +
                            patch + "\"]\n");
    return rows_of("mode_field.csv");
  };
  const auto above = table_on("top");
  const auto below = table_on("bottom");
  ASSERT_EQ(above.size(), 7U * 6U);
  ASSERT_EQ(below.size(), above.size());
  double largest = 0.0;
  for (const auto& row : above) largest = std::max(largest, std::abs(row[3]));
  EXPECT_GT(largest, 0.0);
  for (std::size_t i = 0; i < above.size(); ++i) {
    EXPECT_NEAR(below[i][0], above[i][0], 1e-6);
    EXPECT_NEAR(below[i][1], above[i][1], 1e-6);
    EXPECT_NEAR(above[i][2], 0.0, 1e-9);
    EXPECT_NEAR(below[i][2], -0.02, 1e-9);
    EXPECT_NEAR(below[i][3], above[i][3], 0.05 * largest);  // mean_1
  }
}

TEST_F(Interpolate, RefusesATableOfMorePlacesThanAnyNumber) {
  for (const char* pitch : {"1 um", "0.256 nm", "1e-300 m"}) {
    refused(kTruth + "[interpolation]\ntable_pitch = \"" + pitch + "\"\n", "10 million places");
  }
}

TEST_F(Interpolate, RefusesWhatCannotBeMeant) {
  refused("", "nothing is measured");
  refused("[measurement]\nnoise = \"1 %\"\n", "measurement lacks");
  refused("[measurement]\ntruth = \"real.toml\"\nmodes = 40\n", "raise modes.count");
  refused("[measurement]\ntruth = \"real.toml\"\nshapes = \"s.csv\"\n", "expected one of them");
  refused(kTruth + "[interpolation]\nmethods = [\"dynamic_residuals\"]\n",
          "did you mean \"dynamic_residual\"");
  refused(kTruth + "[interpolation]\non = [\"lid\"]\n", "lid");
  refused(kTruth + "[interpolation]\npoint = [{ name = \"p\", at = [\"400 mm\", \"0 mm\"] }]\n",
          "not on the body");
  refused(kTruth + "hold_out = [\"s1\", \"s2\", \"s3\", \"s4\", \"s5\", \"a1\"]\n",
          "three or more");
  write("s.csv", "frequency_hz,s1,s2,s3,s9\n200,1,2,3,4\n");
  refused("[measurement]\nshapes = \"s.csv\"\n", "\"s9\"");
  write("s.csv", "frequency_hz,s1,s2,s3\n200,1,2,x\n");
  refused("[measurement]\nshapes = \"s.csv\"\n", "line 2: s3");
  write("s.csv", "frequency_hz,s1,s2,s3\n200,0,0,0\n");
  refused("[measurement]\nshapes = \"s.csv\"\n", "are 0");
}

// Nothing is known of a mode beyond the lines by itself: no held-out channel is scored by it.
TEST(ScoredModes, AreThoseWithinTheLines) {
  Measured measured;
  measured.shapes.frequency_hz = Eigen::Vector3d(10.0, 20.0, 30.0);
  measured.shapes.values = Eigen::MatrixXd::Ones(2, 3);
  EXPECT_EQ(scored_modes(measured), (std::vector<Eigen::Index>{0, 1, 2}));
  auto model = std::make_shared<IdentifiedModel>();
  model->found.fit.model.frequency_hz = Eigen::Vector4d(10.0, 15.0, 20.0, 30.0);
  model->judgement.beyond_lines = {2};
  measured.fitted_mode = {0, 2, 3};
  measured.identified = model;
  EXPECT_EQ(scored_modes(measured), (std::vector<Eigen::Index>{0, 2}));
}

// Channels along z tell nothing of the motion of a free body in its plane.
TEST(LeftOutOfPredictions, NamesPlacesThatDoNotMoveAlongZ) {
  auto model = std::make_shared<IdentifiedModel>();
  model->found.fit.model.rigid_count = 3;
  model->match.rigid.emplace();
  Interpolated result;
  result.measured.identified = model;
  const std::vector<std::string> names{"up", "across", "down", "oblique"};
  Points directions(4, 3);
  directions << 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.6, 0.8;
  EXPECT_NE(left_out_across_z(result, names, directions).find(" at across, oblique, their band"),
            std::string::npos);
  EXPECT_EQ(left_out_across_z(result, {"up"}, directions), "");
  model->match.rigid.reset();  // the motion is known nowhere, which another sentence says
  EXPECT_EQ(left_out_across_z(result, names, directions), "");
}

}  // namespace
}  // namespace chladni::steps
