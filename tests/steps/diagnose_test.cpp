// chladni diagnose on measurements that are few, odd or of something else: it says what it cannot
// tell, and names nothing that it does not know. The measurements are of a Ritz plate.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>

#include "app/command.h"
#include "base/error.h"
#include "io/frf_file.h"
#include "rotation/turn.h"
#include "show/diagnosis.h"
#include "simulators/hidden/hidden_effect.h"
#include "steps/diagnosis.h"
#include "tests/app/quiet_run.h"

namespace chladni::steps {
namespace {

using diagnosis::Verdict;

std::string channel(const char* kind, const modal::MeasuredChannel& of) {
  return fmt::format("[[{}]]\nname = \"{}\"\nat = [\"{} mm\", \"{} mm\"]\ndirection = \"z\"\n{}",
                     kind, of.name, 1e3 * of.position->x(), 1e3 * of.position->y(),
                     std::string_view(kind) == "sensor" ? "quantity = \"displacement\"\n" : "");
}

// What was measured, and a study of the table as it is believed to be.
class Diagnose : public testing::Test {
 protected:
  modal::FrfSet measured_of(const std::vector<std::string>& kinds,
                            const std::vector<Eigen::Index>& sensors,
                            const std::vector<Eigen::Index>& actuators, unsigned seed = 3) {
    simulators::HiddenOptions options;
    options.lines = 120;
    options.degree = 12;
    options.severity = 0.7;
    options.on_face = true;
    const auto made = simulators::hidden_case(kinds, seed, options);
    truth_ = made.truth;
    return modal::part(made.measured, sensors, actuators);
  }

  steps::Diagnosed diagnosed_from(const modal::FrfSet& measured, const std::string& plan = "") {
    (void)io::write_frf(folder_.path() / "measured.csv", measured);
    std::string text =
        "geometry = { plate = { length = \"600 mm\", width = \"600 mm\", thickness = \"20 mm\" } "
        "}\n"
        "material = { youngs_modulus = \"70 GPa\", poissons_ratio = 0.33, density = \"2700 "
        "kg/m^3\" }\n"
        "mesh = { edge_length = \"40 mm\" }\nmodes = { damping_ratio = 0.005 }\n"
        "[measurement]\nfrf = \"measured.csv\"\n[identification]\nunit = \"m\"\n[diagnosis]\n" +
        plan;
    for (const auto& one : measured.outputs) text += channel("sensor", one);
    for (const auto& one : measured.inputs) text += channel("actuator", one);
    const auto file = folder_.path() / "study.toml";
    std::ofstream(file) << text;
    const study::Study study = study::read_study(file);
    app::QuietRun quiet(study, folder_.path());
    auto result = steps::diagnosed(study, quiet.run());
    said_ = quiet.said();
    return result;
  }

  // Whatever the verdict: no other name than `effect` ("": none at all) is sure.
  static void expect_no_sure_name_but(const std::string& effect,
                                      const diagnosis::Diagnosis& result) {
    for (const auto& cause : result.best.causes) {
      if (cause.effect != effect) {
        EXPECT_LE(cause.probability, 0.9) << show::verdict_text(result);
      }
    }
  }

  // What was hidden, where it is, within its deviation.
  void expect_the_mass(const diagnosis::Cause& cause, double within_m) const {
    ASSERT_EQ(cause.effect, "point_mass");
    EXPECT_LT((*cause.place - *truth_.front().place).norm(), within_m);
    const auto& mass = cause.parameters.front();
    ASSERT_EQ(mass.name, "mass");
    EXPECT_NEAR(mass.value, truth_.front().size.at("mass"), 3.0 * mass.std);
  }

  app::TestFolder folder_{"diagnose"};
  std::string said_;
  std::vector<simulators::HiddenEffect> truth_;
};

TEST_F(Diagnose, OneResponseOfASoundTableAccusesNothing) {
  EVERY_FOURTH_LANDING();
  const auto one = diagnosed_from(measured_of({}, {0}, {5}));
  EXPECT_EQ(one.result.verdict, Verdict::no_discrepancy) << show::verdict_text(one.result);
  EXPECT_FALSE(one.extended.has_value());
}

// A sound table: what matters is what would have been seen.
TEST_F(Diagnose, SaysWhatItWouldHaveFound) {
  EVERY_FOURTH_LANDING();
  const auto one = diagnosed_from(measured_of({}, {0, 2}, {4, 6, 9}),
                                  "effects = [\"point_mass\", \"sensor_gain\", \"sensor_sign\"]\n");
  const io::Json json = show::diagnosis_json(one);
  const auto& all = json.at("detectable").array();
  ASSERT_EQ(all.size(), 9U);
  double mass = 0.0;
  for (const auto& entry : all) {
    if (entry.at("effect").string() != "point_mass") continue;
    EXPECT_EQ(entry.at("unit").string(), "kg");
    EXPECT_EQ(entry.at("place_m").array().size(), 2U);
    if (entry.at("of").string() == "median") mass = entry.at("size").number();
  }
  EXPECT_GT(mass, 1e-4);
  EXPECT_LT(mass, 0.5);
  EXPECT_NE(show::diagnosis_table(one).find("99 times in 100: point_mass of"), std::string::npos);
}

// A soft patch may do the same to one response, or a mass elsewhere: then none is sure.
TEST_F(Diagnose, OneResponseIsNotTakenForMoreThanItIs) {
  EVERY_EIGHTH_LANDING();
  int named = 0;
  for (const unsigned seed : {3U, 4U}) {
    const auto one = diagnosed_from(measured_of({"point_mass"}, {0}, {5}, seed));
    const auto& result = one.result;
    ASSERT_FALSE(result.best.causes.empty()) << seed;
    if (result.verdict != Verdict::named) {
      EXPECT_EQ(result.verdict, Verdict::ambiguous) << seed << show::verdict_text(result);
      expect_no_sure_name_but("", result);
      continue;
    }
    ++named;
    ASSERT_EQ(result.best.causes.size(), 1U) << seed << show::verdict_text(result);
    expect_the_mass(result.best.causes.front(), 10e-3);
  }
  EXPECT_GE(named, 1);
}

TEST_F(Diagnose, ATurnedSensorIsSeenInOneResponse) {
  EVERY_FOURTH_LANDING();
  auto measured = measured_of({}, {0}, {5});
  for (auto& value : measured.value) value = -value;
  const auto one = diagnosed_from(measured);
  ASSERT_EQ(one.result.best.causes.size(), 1U) << show::verdict_text(one.result);
  EXPECT_EQ(one.result.best.causes.front().effect, "sensor_sign");
  EXPECT_LT(one.gain.fit_after, 0.05);
}

TEST_F(Diagnose, AMassIsFoundWithoutACollocatedPair) {
  EVERY_EIGHTH_LANDING();
  const auto one = diagnosed_from(measured_of({"point_mass"}, {0, 2}, {4, 6, 9}));
  EXPECT_EQ(one.result.verdict, Verdict::named) << show::verdict_text(one.result);
  ASSERT_EQ(one.result.best.causes.size(), 1U) << show::verdict_text(one.result);
  expect_the_mass(one.result.best.causes.front(), 5e-3);
  EXPECT_LT(one.result.best.causes.front().parameters.front().std,
            0.05 * truth_.front().size.at("mass"));
}

TEST_F(Diagnose, AnotherTableIsNotExplained) {
  EVERY_FOURTH_LANDING();
  const auto one = diagnosed_from(measured_of({"other_plate"}, {0, 2}, {4, 6, 9}));
  EXPECT_EQ(one.result.verdict, Verdict::unexplained) << show::verdict_text(one.result);
  expect_no_sure_name_but("", one.result);
}

TEST_F(Diagnose, NoiseThatIsNotStatedIsEstimatedAndSaid) {
  EVERY_FOURTH_LANDING();
  auto measured = measured_of({}, {0, 1}, {3, 5});
  measured.variance.clear();
  const auto one = diagnosed_from(measured, "effects = [\"point_mass\", \"sensor_gain\"]\n");
  EXPECT_NE(said_.find("state no variance: it is estimated"), std::string::npos) << said_;
  EXPECT_EQ(one.result.verdict, Verdict::no_discrepancy) << show::verdict_text(one.result);
  EXPECT_TRUE(one.result.best.causes.empty());
}

TEST_F(Diagnose, ABandWithoutModesIsRefused) {
  auto measured = measured_of({}, {0}, {5});
  measured.frequency_hz.array() += 1e5;
  try {
    (void)diagnosed_from(measured);
    FAIL();
  } catch (const InvalidInput& e) {
    const std::string what = e.what();
    EXPECT_NE(what.find("study.toml: 0 measured lines"), std::string::npos) << what;
    EXPECT_NE(what.find("100020"), std::string::npos) << what;  // where they are
  }
}

TEST_F(Diagnose, AnEffectThatIsNotThereIsRefused) {
  try {
    (void)diagnosed_from(measured_of({}, {0}, {5}), "effects = [\"gremlin\"]\n");
    FAIL();
  } catch (const InvalidInput& e) {
    const std::string what = e.what();
    EXPECT_NE(what.find("gremlin"), std::string::npos) << what;
    EXPECT_NE(what.find("chladni list effects"), std::string::npos) << what;
  }
}

}  // namespace
}  // namespace chladni::steps
