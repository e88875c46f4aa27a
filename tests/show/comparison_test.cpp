// A comparison as people and programs see it.
#include "show/comparison.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "base/error.h"
#include "rotation/turn.h"
#include "show/interpolation.h"
#include "simulators/frf_cases.h"
#include "steps/interpolation.h"
#include "tests/app/quiet_run.h"

namespace chladni::show {
namespace {

namespace fs = std::filesystem;

const simulators::FrfCase& table() {
  static const auto made = simulators::oat4x13();
  return made;
}

std::vector<Eigen::MatrixXcd> simulation() {
  auto other = table().truth;
  other.frequency_hz *= 1.01;
  return modal::frf(other, table().measured.frequency_hz).value;
}

// Its first two sensors exchanged, against a simulation that is 1 % too high.
diagnosis::Comparison comparison() {
  auto measured = table().measured;
  for (auto& value : measured.value) value.row(0).swap(value.row(1));
  auto model = table().truth;
  model.frequency_hz *= 1.01;
  identification::ModalFit fit;
  fit.model = table().truth;
  fit.frequency_std_hz = Eigen::VectorXd::Constant(20, 0.01);
  fit.damping_std = Eigen::VectorXd::Constant(20, 1e-5);
  fit.output_std = Eigen::MatrixXd::Zero(4, 20);
  fit.input_std = Eigen::MatrixXd::Zero(20, 13);
  diagnosis::Comparison result;
  result.modes = diagnosis::compared(model, fit);
  result.responses = diagnosis::compared(measured, simulation());
  result.swaps = diagnosis::swaps(measured, simulation());
  result.reciprocity = diagnosis::reciprocity(measured, model);
  return result;
}

TEST(ComparisonTable, TellsWhatStandsOut) {
  const auto text = show::comparison_table(comparison());
  for (const auto* part : {"140.390", "139.0000 +- 0.01", "-0.990", "y1 and y2 look exchanged",
                           "responses off by", "to     2398 Hz", "CoMAC"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " is not in\n" << text;
  }
}

// What nothing tells is not infinite.
TEST(ComparisonTable, CallsADeviationThatIsNotKnownUnknown) {
  auto one = comparison();
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  auto& pair = one.modes.pairs.front();
  pair.measured_std_hz = pair.change_std = pair.measured_damping_std = kInfinite;
  const auto text = show::comparison_table(one);
  EXPECT_EQ(text.find("inf"), std::string::npos) << text;
  EXPECT_NE(text.find("139.0000 +- unknown"), std::string::npos) << text;
}

// Modes without a partner by their frequencies, poles that are none with the reason.
TEST(ComparisonTable, ListsWhatHasNoPartner) {
  diagnosis::ModeComparison modes;
  modes.simulated_alone = {{6, 264.06, {}}, {8, 463.1, {}}};
  modes.measured_alone = {{4, 300.0, {}}};
  modes.no_modes = {{9, 1499.0, "beside the band"}, {3, 50.0, "damping ratio 0.6: no resonance"}};
  modes.shapes_tell = false;
  modes.confusion = 0.8;
  const auto lines = show::unpaired_lines(modes);
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(lines[0], "simulated within the band, without a measured partner: 264.06 Hz, 463.1 Hz");
  EXPECT_EQ(lines[1], "measured, without a simulated partner: 300 Hz");
  EXPECT_EQ(lines[2],
            "poles of the fit that are no modes of the band: 1499 Hz (beside the band), 50 Hz "
            "(damping ratio 0.6: no resonance)");
  EXPECT_NE(lines[3].find("paired by frequency alone"), std::string::npos);
  diagnosis::Comparison all = comparison();
  all.modes = modes;
  EXPECT_NE(show::comparison_table(all).find(lines[0]), std::string::npos);
  const io::Json json = show::comparison_json(all);
  EXPECT_EQ(json.at("simulated_alone").array()[1].at("mode").number(), 9.0);
  EXPECT_EQ(json.at("simulated_alone").array()[1].at("frequency_hz").number(), 463.1);
  EXPECT_EQ(json.at("no_modes").array()[0].at("why").string(), "beside the band");
}

TEST(ComparisonJson, HasANumberForEach) {
  const io::Json json = show::comparison_json(comparison());
  EXPECT_EQ(json.at("modes").array().size(), 17U);
  const auto& first = json.at("modes").array().front();
  EXPECT_NEAR(first.at("change").number(), 1.0 / 1.01 - 1.0, 1e-12);
  EXPECT_NEAR(first.at("mac").number(), 1.0, 1e-9);
  EXPECT_EQ(first.at("paired_by").string(), "shape");
  EXPECT_EQ(json.at("per_channel").array().size(), 52U);
  EXPECT_EQ(json.at("per_channel").array()[1].at("sensor").string(), "y2");
  EXPECT_EQ(json.at("sensors").array().size(), 4U);
  EXPECT_EQ(json.at("actuators").array().size(), 13U);
  EXPECT_GT(json.at("relative_error").number(), 0.1);
  EXPECT_EQ(json.at("exchanged").array().front().at("side").string(), "sensors");
  EXPECT_FALSE(io::text(json).empty());
}

// An error that is not known is not an error of zero.
TEST(ComparisonPictures, LeaveWhatIsNotKnownEmpty) {
  auto known = comparison();
  EXPECT_EQ(show::errors_picture(known).title, "Error of each response, % of its size");
  auto& error = known.responses.error;
  error.setConstant(0.02);
  error(1, 2) = std::numeric_limits<double>::quiet_NaN();
  error(0, 1) = std::numeric_limits<double>::infinity();
  const auto some = show::errors_picture(known);
  EXPECT_TRUE(std::isnan(some.value(1, 2)));
  EXPECT_DOUBLE_EQ(some.dark, 2.0);
  EXPECT_NE(some.title.find("empty: not known"), std::string::npos);
  error.setConstant(std::numeric_limits<double>::quiet_NaN());
  const auto none = show::errors_picture(known);
  EXPECT_FALSE(none.value.array().isFinite().any());
  EXPECT_GT(none.dark, none.light);
  EXPECT_GT(none.dark, 1e-3);  // no scale that any error would be dark on
}

TEST(ComparisonPictures, AreThere) {
  EVERY_FOURTH_LANDING();
  const app::TestFolder folder("comparison");
  const auto png = [&](const char* name) { return folder.path() / name; };
  show::draw_responses(png("responses.png"), table().measured, simulation(), table().exact);
  show::draw_mac(png("mac.png"), comparison());
  show::draw_errors(png("errors.png"), comparison());
  for (const auto* name : {"responses.png", "mac.png", "errors.png"}) {
    EXPECT_GT(fs::file_size(png(name)), 2000U) << name;
  }
  show::draw_mac(png("none.png"), {});
  EXPECT_FALSE(fs::exists(png("none.png")));
  EXPECT_THROW(show::draw_responses(png("none.png"), table().measured, {}), InvalidInput);
}

// One sensor was measured, one place was not.
TEST(PredictionsPicture, IsThere) {
  const app::TestFolder folder("predictions");
  steps::IdentifiedModel model;
  model.measured.all = table().measured;
  model.measured.inputs = {0, 1, 2};
  auto predicted = modal::part(table().measured, {3, 2}, {0, 1, 2});
  predicted.outputs[1].name = "corner";
  if (predicted.variance.empty()) {
    for (const auto& value : predicted.value)
      predicted.variance.push_back(1e-4 * value.cwiseAbs2());
  }
  show::draw_predictions(model, predicted, folder.path() / "predicted.png");
  EXPECT_GT(fs::file_size(folder.path() / "predicted.png"), 2000U);
}

}  // namespace
}  // namespace chladni::show
