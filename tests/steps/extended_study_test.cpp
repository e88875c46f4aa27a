// A study that says what was wrong with it, read back.
#include "steps/extend/extended_study.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "diagnosis/effect.h"
#include "extended_plate.h"
#include "stage/plane_stress.h"
#include "steps/extend/extension.h"

namespace chladni::steps {
namespace {

study::Study read(const steps::ExtendedStudy& extended) {
  EXPECT_TRUE(extended.unexpressed.empty()) << extended.unexpressed.front();
  return study::parse_study(extended.text, kFile);
}

// --- What stands in the file.

TEST(ExtendedStudy, WithoutCausesIsTheStudyItself) { EXPECT_EQ(extended({}).text, kStudy); }

TEST(ExtendedStudy, KeepsCommentsAndNamesTheCause) {
  const auto text = extended({cause("youngs_modulus", {{"relative", 0.02}})}).text;
  EXPECT_NE(text.find("# a free plate, ä comment that stays\n"), std::string::npos);
  EXPECT_NE(text.find("# 6.5 kg\n"), std::string::npos);
  EXPECT_NE(text.find("# diagnosis: youngs_modulus: relative = 0.02 ± 0.0002; probability 0.98; "
                      "before: \"70 GPa\"\nmaterial = { youngs_modulus = \"71.4 GPa\""),
            std::string::npos)
      << text;
}

// Beside a reference that was measured before the cause, a model that has the cause found it again.
TEST(ExtendedStudy, HasNoReferenceFromBeforeItsCauses) {
  auto text = kStudy;
  const std::string frf = "frf = \"measured.uff\"";
  text.replace(text.find(frf), frf.size(), "modes = \"after.csv\"\nreference = \"before.csv\"");
  EXPECT_EQ(study::parse_study(text, kFile).measurement->reference.filename(), "before.csv");
  const auto with = extended({cause("youngs_modulus", {{"relative", 0.02}})}, text);
  EXPECT_TRUE(read(with).measurement->reference.empty()) << with.text;
  EXPECT_EQ(extended({}, text).text, text);
}

TEST(ExtendedStudy, ScalesTheBody) {
  const auto study = read(extended(
      {cause("youngs_modulus", {{"relative", -0.1}}), cause("density", {{"relative", 0.05}}),
       cause("thickness", {{"relative", 0.02}}), cause("modal_damping", {{"factor", 3.0}}),
       cause("youngs_modulus", {{"relative", 0.5}})}));
  const auto& constants = study.materials.at(0).constants;
  EXPECT_NEAR(constants[0].second, 70e9 * 0.9 * 1.5, 1e3);
  EXPECT_NEAR(constants[2].second, 2700.0 * 1.05, 1e-6);
  EXPECT_NEAR(std::get<mesh::Plate>(study.geometry.body).thickness, 0.0102, 1e-12);
  EXPECT_NEAR(study.modes.damping_ratio, 0.015, 1e-12);
}

// The text of a study states the constants that a name stands for.
TEST(ExtendedStudy, MakesANamedMaterialOrthotropic) {
  auto text = kStudy;
  const auto begin = text.find("material = ");
  text.replace(begin, text.find('\n', begin) - begin, "material = \"aluminium 6061\"");
  const auto named = study::parse_study(text, kFile);
  const auto result =
      extended({cause("orthotropy", {{"along_u", 0.1}, {"shear", 0.05}})}, named.text);
  EXPECT_TRUE(result.unexpressed.empty()) << result.unexpressed.front();
  const auto study = read(result);
  EXPECT_EQ(study.materials.at(0).symmetry, "orthotropic");
  const auto& before = named.materials.at(0).material;
  const auto& after = study.materials.at(0).material;
  EXPECT_NEAR(after.density, before.density, 1e-9 * before.density);
  const double more = (after.stiffness - before.stiffness)(0, 0) /
                      stage::plane_stress(before.stiffness, 0, 1)(0, 0);
  EXPECT_NEAR(more, 0.1, 1e-6);
}

TEST(ExtendedStudy, SaysThatAQuadrilateralHasNotOneSize) {
  auto text = kStudy;
  const auto begin = text.find("plate = {");
  text.replace(
      begin, text.find('}', begin) + 1 - begin,
      "quadrilateral = { corners = [[\"-300 mm\", \"-200 mm\"], [\"300 mm\", \"-200 mm\"], "
      "[\"300 mm\", \"200 mm\"], [\"-290 mm\", \"200 mm\"]], thickness = \"10 mm\" }");
  const auto result = extended({cause("size_error", {{"relative", 0.01}})}, text);
  ASSERT_EQ(result.unexpressed.size(), 1U);
  EXPECT_NE(result.unexpressed[0].find("quadrilateral"), std::string::npos);
}

TEST(ExtendedStudy, HangsThingsOnTheBody) {
  const auto study =
      read(extended({cause("point_mass", {{"mass", 0.2}, {"u", 0.12}, {"v", -0.08}}),
                     cause("point_mass", {{"mass", 0.1}, {"u", 0.0}, {"v", 0.0}}),
                     cause("mass_with_inertia",
                           {{"mass", 0.3}, {"radius_of_gyration", 0.02}, {"u", 0.1}, {"v", 0.1}}),
                     cause("ground_spring", {{"stiffness", 1e4}, {"u", 0.1}, {"v", 0.1}}),
                     cause("ground_damper", {{"damping", 5.0}, {"u", 0.1}, {"v", 0.1}}),
                     resonator(80.0, 0.02, 0.1, 0.1)}));
  ASSERT_EQ(study.attachments.size(), 6U);
  EXPECT_EQ(study.attachments[1].name, "diagnosed_mass_2");
  EXPECT_LT((study.attachments[0].at.point - Eigen::Vector3d(0.12, -0.08, 0.0)).norm(), 1e-12);
  EXPECT_TRUE(study.attachments[0].at.from_above);
  EXPECT_NEAR(std::get<fem::PointMass>(study.attachments[0].what).mass, 0.2, 1e-12);
  const auto& inertia = std::get<fem::PointMass>(study.attachments[2].what).inertia;
  EXPECT_LT((inertia.diagonal() - 0.3 * 4e-4 * Eigen::Vector3d(1, 1, 0)).norm(), 1e-12);
  EXPECT_NEAR(std::get<fem::GroundSpring>(study.attachments[3].what).stiffness, 1e4, 1e-6);
  EXPECT_NEAR(std::get<fem::GroundSpring>(study.attachments[4].what).damping, 5.0, 1e-9);
  const auto& resonator = std::get<fem::Resonator>(study.attachments[5].what);
  EXPECT_NEAR(std::sqrt(resonator.stiffness / resonator.mass), 160.0 * std::numbers::pi, 1e-6);
}

// The place of a cause is one of the body as drawn: it moves as the body grows.
TEST(ExtendedStudy, HangsThingsOnTheBodyAsItHasGrown) {
  const auto mass = cause("point_mass", {{"mass", 0.2}, {"u", 0.12}, {"v", -0.08}});
  const auto growth = cause("size_error", {{"relative", 0.05}});
  for (const auto& causes : {std::vector{mass, growth}, std::vector{growth, mass}}) {
    const auto study = read(extended(causes));
    ASSERT_EQ(study.attachments.size(), 1U);
    EXPECT_LT((study.attachments[0].at.point - Eigen::Vector3d(0.126, -0.084, 0.0)).norm(), 1e-12);
  }
  const auto twice = read(extended({growth, mass, growth}));
  EXPECT_NEAR(twice.attachments.at(0).at.point.x(), 0.12 * 1.05 * 1.05, 1e-12);
}

TEST(ExtendedStudy, VariesTheBody) {
  const auto study = read(extended(
      {cause("local_stiffness", {{"factor", -0.3}, {"u", 0.1}, {"v", -0.05}, {"radius", 0.06}}),
       cause("thickness_field", {{"u1", 0.03}, {"u2", 0.02}})}));
  ASSERT_EQ(study.variations.size(), 2U);
  EXPECT_EQ(study.variations[0].of, "stiffness");
  EXPECT_NEAR(study.variations[0].radius, 0.06, 1e-12);
  EXPECT_NEAR(study.variations[0].relative, -0.3, 1e-12);
  EXPECT_LT((study.variations[0].at->point - Eigen::Vector3d(0.1, -0.05, 0.0)).norm(), 1e-12);
  EXPECT_EQ(study.variations[1].of, "thickness");
  EXPECT_EQ(study.variations[1].waves, (std::array<double, 5>{0.03, 0.0, 0.02, 0.0, 0.0}));
}

TEST(ExtendedStudy, CorrectsChannels) {
  const auto study = read(
      extended({cause("sensor_sign", {}, {"s1"}), cause("actuator_sign", {}, {"a1"}),
                cause("sensor_gain", {{"relative", 0.1}}, {"s2"}),
                cause("actuator_gain", {{"relative", -0.2}}, {"a2"}),
                cause("overall_gain", {{"relative", 0.5}}),
                cause("sensor_delay", {{"delay", 2e-5}}, {"s1"}), cause("delay", {{"delay", 1e-5}}),
                cause("actuator_low_pass", {{"frequency", 3000.0}}, {"a1"}),
                cause("actuator_low_pass", {{"frequency", 3000.0}}, {"a1"})}));
  EXPECT_TRUE(study.sensors[0].direction.isApprox(-Eigen::Vector3d::UnitZ()));
  EXPECT_TRUE(study.actuators[0].direction.isApprox(Eigen::Vector3d::UnitZ()));
  EXPECT_NEAR(study.sensors[0].gain, 1.5, 1e-9);
  EXPECT_NEAR(study.sensors[1].gain, 1.1 * 1.1 * 1.5, 1e-9);
  EXPECT_NEAR(study.actuators[1].gain, 0.8, 1e-9);
  EXPECT_NEAR(study.sensors[0].delay, 3e-5, 1e-12);
  EXPECT_NEAR(study.sensors[1].delay, 1e-5, 1e-12);
  EXPECT_NEAR(study.actuators[0].low_pass_hz, 1500.0, 1e-6);
}

TEST(ExtendedStudy, MovesTiltsAndRenamesChannels) {
  const auto study =
      read(extended({cause("sensor_position", {{"u", 0.004}, {"v", -0.002}}, {"s1"}),
                     cause("actuator_direction", {{"toward_u", 0.1}, {"toward_v", 0.0}}, {"a2"}),
                     cause("sensor_quantity", {{"derivative", 2.0}}, {"s1"}),
                     cause("sensor_unit", {{"factor", 9.80665}}, {"s1"}),
                     cause("swapped_actuators", {}, {"a1", "a2"})}));
  EXPECT_LT((study.sensors[0].at.point - Eigen::Vector3d(-0.246, 0.148, 0.0)).norm(), 1e-9);
  EXPECT_EQ(study.sensors[0].quantity, "acceleration");
  EXPECT_NEAR(study.sensors[0].gain, 9.80665, 1e-9);
  EXPECT_EQ(study.actuators[0].name, "a2");
  EXPECT_EQ(study.actuators[1].name, "a1");
  EXPECT_LT((study.actuators[1].direction - Eigen::Vector3d(0.1, 0.0, 1.0).normalized()).norm(),
            1e-9);
}

// Record s1 is the sensor of s3, which gets the name s1, and so on.
TEST(ExtendedStudy, GivesEachRecordTheSensorThatItIs) {
  auto mixed = cause("permuted_sensors", {}, {"s1", "s2", "s3"});
  mixed.truly = {"s3", "s1", "s2"};
  const std::string third =
      "\n[[sensor]]\nname = \"s3\"\nat = [\"0 mm\", \"0 mm\"]\ndirection = \"z\"\n";
  const auto study = read(extended({mixed}, kStudy + third));
  EXPECT_EQ(study.sensors[0].name, "s2");
  EXPECT_EQ(study.sensors[1].name, "s3");
  EXPECT_EQ(study.sensors[2].name, "s1");
}

// A position is of the channel that the study has, a gain of the record, whatever comes first.
TEST(ExtendedStudy, KeepsTheMeaningOfNamesThatAreExchanged) {
  const auto moved = cause("sensor_position", {{"u", 0.004}, {"v", -0.002}}, {"s1"});
  const auto gain = cause("sensor_gain", {{"relative", 0.5}}, {"s1"});
  const auto turned = cause("sensor_sign", {}, {"s1"});
  const auto exchange = cause("swapped_sensors", {}, {"s1", "s2"});
  for (const auto& causes : std::vector<std::vector<diagnosis::Cause>>{
           {gain, turned, exchange, moved}, {exchange, moved, turned, gain}}) {
    const auto study = read(extended(causes));
    EXPECT_EQ(study.sensors[0].name, "s2");
    EXPECT_LT((study.sensors[0].at.point - Eigen::Vector3d(-0.246, 0.148, 0.0)).norm(), 1e-9);
    EXPECT_EQ(study.sensors[0].gain, 1.0);
    EXPECT_GT(study.sensors[0].direction.z(), 0.0);
    EXPECT_EQ(study.sensors[1].name, "s1");
    EXPECT_NEAR(study.sensors[1].gain, 1.1 * 1.5, 1e-9);
    EXPECT_LT(study.sensors[1].direction.z(), 0.0);
  }
}

// s3 stands in the study and not in the file of the responses.
TEST(ExtendedStudy, TakesAllThatWereMeasuredForAll) {
  const std::string third =
      "\n[[sensor]]\nname = \"s3\"\nat = [\"0 mm\", \"0 mm\"]\ndirection = \"z\"\n";
  const auto wrong = cause("sensor_quantity", {{"derivative", 2.0}}, {"s1", "s2"});
  const auto text = kStudy + "[identification]\nunit = \"mm\"\n" + third;
  const auto study = read(extended({wrong}, text, {{"s1", "s2"}, {"a1", "a2"}, {}}));
  EXPECT_EQ(study.identification->unit, "mm/s^2");
  for (const auto& sensor : study.sensors) EXPECT_EQ(sensor.quantity, "acceleration");
  EXPECT_EQ(extended({wrong}, text, {{"s1", "s2", "s3"}, {"a1", "a2"}, {}}).unexpressed.size(), 1U);
}

TEST(ExtendedStudy, HangsMassesOnTheChannelsThatTheFitHad) {
  const auto masses = cause("sensor_masses", {{"mass", 0.01}});
  EXPECT_EQ(read(extended({masses})).attachments.size(), 2U);
  const auto study = read(extended({masses}, kStudy, {{"s2"}, {"a1"}, {}}));
  ASSERT_EQ(study.attachments.size(), 1U);
  EXPECT_EQ(study.attachments[0].at.point, study.sensors[1].at.point);
}

// Seen along x, the body lies 100 mm below the plane of the chart: what hangs there hangs on it.
TEST(ExtendedStudy, HangsThingsBelowTheirPlaceOnTheChart) {
  diagnosis::Surface side;
  side.origin = {0.3, 0.0, 0.0};
  side.axis_u = Eigen::Vector3d::UnitY();
  side.axis_v = Eigen::Vector3d::UnitZ();
  steps::DiagnosedOn on;
  on.height = [](const Eigen::Vector2d& place) { return -0.1 - place(0); };
  const auto study = read(steps::extended_study(
      kStudy, kFile, side, {cause("point_mass", {{"mass", 0.2}, {"u", 0.05}, {"v", 0.004}})},
      "bench", {}, true, on));
  ASSERT_EQ(study.attachments.size(), 1U);
  EXPECT_LT((study.attachments[0].at.point - Eigen::Vector3d(0.15, 0.05, 0.004)).norm(), 1e-9);
}

// The unit that the study states is of all sensors: it goes with a quantity of all of them.
TEST(ExtendedStudy, DifferentiatesTheUnitWithTheQuantity) {
  const auto with = [&](const std::string& unit, double times, std::vector<std::string> channels) {
    return extended({cause("sensor_quantity", {{"derivative", times}}, channels)},
                    kStudy + "[identification]\nunit = \"" + unit + "\"\n");
  };
  const std::vector<std::string> all = {"s1", "s2"};
  EXPECT_EQ(read(with("mm", 2.0, all)).identification->unit, "mm/s^2");
  EXPECT_EQ(read(with("um/N", 1.0, all)).identification->unit, "um/s/N");
  EXPECT_EQ(read(with("mm", 2.0, all)).sensors[1].quantity, "acceleration");
  const auto one = with("mm", 2.0, {"s1"});
  ASSERT_EQ(one.unexpressed.size(), 1U);
  EXPECT_NE(one.unexpressed[0].find("unit is that of all sensors"), std::string::npos);
  EXPECT_EQ(study::parse_study(one.text, kFile).sensors[0].quantity, "displacement");
}

TEST(ExtendedStudy, WritesEveryStyleOfTable) {
  const std::string text = R"(geometry.plate.length = "600 mm"
geometry.plate.width = "400 mm"
geometry.plate.thickness = "10 mm"
material.youngs_modulus = "70 GPa"
material.poissons_ratio = 0.33
material.density = "2.7 g/cm^3" # light
sensor = [ { name = "s1", at = ["0 mm", "0 mm"], direction = "z" },
           { direction = "z", at = ["50 mm",
               "10 mm"], name = "s2" } ]
actuator = [{ name = "a1", at = ["0 mm", "0 mm"], direction = "z" }]
attachment = [])";
  const auto found = extended(
      {cause("sensor_gain", {{"relative", 0.1}}, {"s2"}),
       cause("sensor_delay", {{"delay", 1e-6}}, {"s1"}), cause("density", {{"relative", 0.1}}),
       cause("sensor_position", {{"u", 0.001}, {"v", 0.003}}, {"s2"}),
       cause("orthotropy", {{"along_u", 0.1}, {"shear", -0.1}}),
       cause("point_mass", {{"mass", 0.2}, {"u", 0.1}, {"v", 0.1}}),
       cause("point_mass", {{"mass", 0.3}, {"u", 0.1}, {"v", 0.1}})},
      text);
  const auto study = read(found);
  EXPECT_NEAR(study.sensors[1].gain, 1.1, 1e-9);
  EXPECT_NEAR(study.sensors[0].delay, 1e-6, 1e-15);
  EXPECT_LT((study.sensors[1].at.point - Eigen::Vector3d(0.051, 0.013, 0.0)).norm(), 1e-9);
  EXPECT_EQ(study.materials[0].symmetry, "orthotropic");
  EXPECT_NEAR(study.materials[0].material.density, 2970.0, 1e-6);
  ASSERT_EQ(study.attachments.size(), 2U);
  EXPECT_NEAR(std::get<fem::PointMass>(study.attachments[1].what).mass, 0.3, 1e-9);
  EXPECT_NE(found.text.find("# light"), std::string::npos);
}

TEST(ExtendedStudy, SaysWhatItCannot) {
  const auto found = extended({cause("frame", {{"mass", 50.0}, {"frequency", 30.0}}),
                               cause("point_mass", {{"mass", -0.1}, {"u", 0.0}, {"v", 0.0}}),
                               cause("sensor_gain", {{"relative", 0.1}}, {"s1"})});
  ASSERT_EQ(found.unexpressed.size(), 2U);
  EXPECT_EQ(found.unexpressed[0], "frame: a study has no key for it");
  EXPECT_NE(found.text.find("# diagnosis: frame: mass = 50"), std::string::npos);
  EXPECT_NE(found.text.find("# Not in this study: an attachment has no negative mass"),
            std::string::npos);
  const auto study = study::parse_study(found.text, kFile);
  EXPECT_TRUE(study.attachments.empty());
  EXPECT_NEAR(study.sensors[0].gain, 1.1, 1e-9);
}

TEST(ExtendedStudy, SaysThatAResonatorIsDampedMoreThanWasFound) {
  const auto found = extended({resonator(80.0, 0.002, 0.1, 0.1)});
  EXPECT_NE(found.text.find("# Its damping, 0.002, is below the 0.005"), std::string::npos)
      << found.text;
}

TEST(ExtendedStudy, SaysWhatIsOfTheExperiment) {
  const auto found = extended({cause("drift", {{"first_to_last", 1e-3}}),
                               cause("sensor_crosstalk", {{"share", 0.02}}, {"s1", "s2"}),
                               cause("suspension", {{"frequency", 5.0}, {"damping_ratio", 0.1}}),
                               cause("modes_above", {{"relative", 0.5}})});
  ASSERT_EQ(found.unexpressed.size(), 4U);
  EXPECT_NE(found.unexpressed[0].find("one temperature"), std::string::npos);
  EXPECT_NE(found.unexpressed[1].find("off them"), std::string::npos);
  EXPECT_NE(found.unexpressed[2].find("control loop"), std::string::npos);
  EXPECT_NE(found.unexpressed[3].find("gives way locally"), std::string::npos);
}

// Each effect has keys or says why a study has none, but for two.
TEST(ExtendedStudy, KnowsTheWholeCatalogue) {
  const std::vector<std::string> without_a_key = {"frame", "hysteretic_damping"};
  for (const auto* effect : diagnosis::effects()) {
    const std::string name(effect->name);
    const bool expected =
        std::find(without_a_key.begin(), without_a_key.end(), name) == without_a_key.end();
    const auto& record = effect->in_study;
    const bool is_said = record.table != diagnosis::InStudy::Table::none || !record.refusal.empty();
    EXPECT_EQ(is_said, expected) << name;
  }
}

TEST(ExtendedStudy, SaysThatAPadHasNoKey) {
  const auto found = extended(
      {cause("elastic_pad", {{"stiffness", 1e5}, {"radius", 0.1}, {"u", 0.0}, {"v", 0.0}})});
  ASSERT_EQ(found.unexpressed.size(), 1U);
  EXPECT_NE(found.unexpressed[0].find("say a spring in each of several places"), std::string::npos)
      << found.unexpressed[0];
}

TEST(ExtendedStudy, RefusesCausesThatCannotBe) {
  EXPECT_THROW(static_cast<void>(extended({cause("sensor_gain", {{"relative", 0.1}}, {"s9"})})),
               InvalidInput);
  EXPECT_THROW(static_cast<void>(extended({cause("point_mass", {{"mass", 0.1}, {"u", 0.1}})})),
               InvalidInput);
  EXPECT_THROW(static_cast<void>(extended({cause("youngs_modulus", {{"relative", -1.5}})})),
               InvalidInput);
  EXPECT_THROW(static_cast<void>(extended({}, "geometry = 3")), InvalidInput);
}

TEST(ExtendedStudy, LeadsToTheFilesOfTheStudy) {
  const auto found =
      steps::extended_study(kStudy, "models/bench/study.toml", chart(), {}, "out/bench");
  EXPECT_NE(found.text.find("frf = \"../../models/bench/measured.uff\""), std::string::npos)
      << found.text;
  EXPECT_NE(found.text.find("--allow-outside"), std::string::npos);
}

// The damping of all modes is also a resonator's, so its dashpot has the rest, whatever comes
// first.
TEST(ExtendedStudy, DampsAResonatorAsItWasFoundInAnyOrderOfCauses) {
  const auto damping = cause("modal_damping", {{"factor", 2.0}});
  const auto hung = resonator(80.0, 0.03, 0.1, 0.1);
  for (const auto& causes :
       std::vector<std::vector<diagnosis::Cause>>{{hung, damping}, {damping, hung}}) {
    const auto study = read(extended(causes));
    ASSERT_EQ(study.attachments.size(), 1U);
    const auto& made = std::get<fem::Resonator>(study.attachments[0].what);
    const double ratio = 0.5 * made.damping / std::sqrt(made.stiffness * made.mass);
    EXPECT_NEAR(study.modes.damping_ratio, 0.01, 1e-12);
    EXPECT_NEAR(ratio + study.modes.damping_ratio, 0.03, 1e-9);
  }
}

// Seen from below, an axis of the chart is against that of the body. The stiffness is the same.
TEST(ExtendedStudy, MakesABodyOrthotropicThatIsSeenFromBelow) {
  diagnosis::Surface below;
  below.axis_v = -Eigen::Vector3d::UnitY();
  const auto wanted = cause("orthotropy", {{"along_u", 0.1}, {"shear", 0.05}});
  const auto found = steps::extended_study(kStudy, kFile, below, {wanted}, "bench", {}, true, {});
  const auto usual = read(extended({wanted})).materials.at(0).material.stiffness;
  const auto turned = read(found).materials.at(0).material.stiffness;
  EXPECT_LT((turned - usual).norm(), 1e-9 * usual.norm());
  below.axis_v = Eigen::Vector3d(0.0, 0.6, 0.8);
  EXPECT_EQ(steps::extended_study(kStudy, kFile, below, {wanted}, "bench").unexpressed.size(), 1U);
}

}  // namespace
}  // namespace chladni::steps
