// The study reader: what it takes, and what it says of what it does not take.
#include "study/study.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "base/error.h"
#include "base/sha256.h"
#include "study/problems.h"
#include "tests/refusal.h"

namespace chladni::study {
namespace {

namespace fs = std::filesystem;

// The contract's own example, word by word.
constexpr const char* kContract = R"(
title    = "OAT wafer table, minimal model"
geometry = { plate = { length = "600 mm", width = "600 mm", thickness = "20 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh     = { edge_length = "20 mm" }
modes    = { count = 20, damping_ratio = 0.005 }      # flexible modes

[[attachment]]                # what hangs on the body or holds it
kind = "spring"               # spring, mass, damper, resonator, ...
name = "flexure_1"
at   = ["-250 mm", "0 mm"]
direction = "z"
stiffness = "1200 N/m"

[[sensor]]
name = "s1"
at = ["-250 mm", "250 mm"]
direction = "z"
quantity = "displacement"     # velocity, acceleration

[[sensor]]
name = "s4"
at = ["250 mm", "250 mm", "0 mm"]
direction = [0, 0, 2]

[[actuator]]
name = "a1"
at = ["-200 mm", "200 mm"]
direction = "z"

[placement]
modes = 3                     # or a list, or up_to = "500 Hz"
keep_out = []                 # boxes, discs or named patches

[measurement]
frf = "measured.uff"          # .uff .unv, .mat, .csv
hold_out = ["s4"]             # channels that no fit may see

[expect]                      # a study is also a test
frequency_1 = { value = "183.8 Hz", within = "1 %" }
)";

study::Study parsed(const std::string& text) {
  return study::parse_study(text, "bench/study.toml");
}

/// What the reader says of `text`.
std::string refusal(const std::string& text) {
  return refusal_of([&] { return parsed(text); });
}

/// The contract's study with one piece of text replaced.
std::string changed(const std::string& from, const std::string& to) {
  std::string text = kContract;
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

testing::AssertionResult says(const std::string& message, const std::string& part) {
  if (message.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "\"" << part << "\" is not in\n" << message;
}

TEST(Study, TheContractsExampleIsUnderstoodInSi) {
  const study::Study study = parsed(kContract);
  EXPECT_EQ(study.title, "OAT wafer table, minimal model");
  EXPECT_EQ(study.name, "bench");
  EXPECT_EQ(study.geometry.kind, "plate");
  const auto& plate = std::get<mesh::Plate>(study.geometry.body);
  EXPECT_DOUBLE_EQ(plate.length, 0.6);
  EXPECT_DOUBLE_EQ(plate.thickness, 0.02);
  EXPECT_DOUBLE_EQ(study.materials.at(0).material.density, 2700.0);
  EXPECT_DOUBLE_EQ(study.mesh.edge_length, 0.02);
  EXPECT_EQ(study.modes.count, 20);
  EXPECT_DOUBLE_EQ(study.modes.damping_ratio, 0.005);
  EXPECT_TRUE(study.warnings.empty());
}

TEST(Study, ChannelsAndAttachmentsKeepTheirPlaces) {
  const study::Study study = parsed(kContract);
  ASSERT_EQ(study.sensors.size(), 2U);
  EXPECT_TRUE(study.sensors[0].at.from_above);
  EXPECT_TRUE(study.sensors[0].at.point.isApprox(Eigen::Vector3d(-0.25, 0.25, 0.0)));
  EXPECT_FALSE(study.sensors[1].at.from_above);
  EXPECT_TRUE(study.sensors[1].direction.isApprox(Eigen::Vector3d::UnitZ()));
  EXPECT_EQ(study.sensors[1].quantity, "displacement");
  EXPECT_EQ(study.actuators.at(0).quantity, "force");
  const auto& spring = std::get<fem::GroundSpring>(study.attachments.at(0).what);
  EXPECT_DOUBLE_EQ(spring.stiffness, 1200.0);
}

TEST(Study, PlansForLaterVerbsAreKept) {
  const study::Study study = parsed(kContract);
  EXPECT_EQ(study.placement->modes, (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(study.measurement->hold_out, std::vector<std::string>{"s4"});
  EXPECT_EQ(study.measurement->frf.filename(), "measured.uff");
  ASSERT_EQ(study.expectations.size(), 1U);
  EXPECT_DOUBLE_EQ(study.expectations[0].value, 183.8);
  EXPECT_NEAR(study.expectations[0].within, 1.838, 1e-12);
}

TEST(Study, UnitsChangeNothingButTheNumber) {
  const study::Study a = parsed(kContract);
  const study::Study b = parsed(changed("length = \"600 mm\"", "length = \"0.6 m\""));
  EXPECT_DOUBLE_EQ(std::get<mesh::Plate>(a.geometry.body).length,
                   std::get<mesh::Plate>(b.geometry.body).length);
  const study::Study c = parsed(changed("\"2700 kg/m^3\"", "\"2.7 g/cm^3\""));
  EXPECT_NEAR(c.materials[0].material.density, 2700.0, 1e-9);
}

TEST(Study, PlacementTakesAListOrAFrequency) {
  EXPECT_EQ(parsed(changed("modes = 3  ", "modes = [2, 5]")).placement->modes,
            (std::vector<int>{2, 5}));
  EXPECT_DOUBLE_EQ(parsed(changed("modes = 3  ", "up_to = \"0.5 kHz\"")).placement->up_to_hz,
                   500.0);
  EXPECT_DOUBLE_EQ(
      parsed(changed("modes = 3  ", "modes = { up_to = \"500 Hz\" }")).placement->up_to_hz, 500.0);
}

TEST(Study, KeepOutTakesBoxesDiscsAndPatches) {
  const auto zones =
      parsed(changed("keep_out = []",
                     R"(keep_out = [{ box = { from = ["0 mm", "0 mm"], to = ["9 mm", "8 mm"] } },
                        { disc = { at = ["1 mm", "2 mm"], diameter = "3 mm" } }, { patch = "top" }])"))
          .placement->keep_out;
  ASSERT_EQ(zones.size(), 3U);
  EXPECT_DOUBLE_EQ(zones[0].to(1), 8e-3);
  EXPECT_DOUBLE_EQ(zones[1].diameter, 3e-3);
  EXPECT_EQ(zones[2].patch, "top");
  EXPECT_EQ(
      parsed(changed("keep_out = []", "keep_out = [\"pockets\"]")).placement->keep_out[0].patch,
      "pockets");
}

TEST(Study, LayoutsNameChannels) {
  const std::string layout = "\n[[layout]]\nname = \"now\"\nsensors = [\"s1\", \"s4\"]\n";
  EXPECT_EQ(parsed(kContract + layout).layouts.at(0).sensors.size(), 2U);
  const auto message =
      refusal(std::string(kContract) + "\n[[layout]]\nname=\"n\"\nsensors=[\"s_1\"]\n");
  EXPECT_TRUE(says(message, "no sensor of the study has that name; did you mean \"s1\"?"));
}

TEST(Study, AResonatorIsGivenByFrequencyOrStiffness) {
  const std::string by_frequency = R"(
[[attachment]]
kind = "resonator"
name = "cable"
at = ["0 mm", "0 mm"]
direction = "z"
mass = "10 g"
frequency = "50 Hz"
damping_ratio = 0.02
)";
  const study::Study study = parsed(kContract + by_frequency);
  const auto& resonator = std::get<fem::Resonator>(study.attachments.at(1).what);
  const double omega = 100.0 * std::numbers::pi;
  EXPECT_NEAR(resonator.stiffness, 0.01 * omega * omega, 1e-9);
  EXPECT_NEAR(resonator.damping, 2.0 * 0.02 * 0.01 * omega, 1e-12);
}

TEST(Study, EveryKindOfBodyIsRead) {
  const std::string material =
      "material = { youngs_modulus = \"70 GPa\", poissons_ratio = 0.3, density = \"2700 kg/m^3\" "
      "}\n";
  const auto kind = [&](const std::string& geometry) {
    return parsed("geometry = " + geometry + "\n" + material).geometry;
  };
  EXPECT_EQ(kind(R"({ beam = { length = "1 m", width = "1 cm", thickness = "1 mm" } })").kind,
            "beam");
  EXPECT_EQ(kind(R"({ disc = { diameter = "1 m", thickness = "1 mm" } })").kind, "disc");
  EXPECT_EQ(kind(R"({ sphere = { diameter = "1 m" } })").kind, "sphere");
  const auto table = std::get<mesh::WaferTable>(
      kind(
          R"({ wafer_table = { length = "600 mm", width = "600 mm", height = "50 mm", face_sheet = "8 mm", pockets = [9, 8], rib = "6 mm", edge_cutout = ["80 mm", "20 mm"], corner_cutout = "40 mm", bores = [{ at = ["1 mm", "2 mm"], diameter = "8 mm" }], wafer = { diameter = "300 mm", thickness = "0.775 mm" } } })")
          .body);
  EXPECT_EQ(table.pockets_y, 8);
  EXPECT_DOUBLE_EQ(table.edge_cutout_depth, 0.02);
  EXPECT_DOUBLE_EQ(table.bores.at(0).centre(1), 2e-3);
  EXPECT_DOUBLE_EQ(table.wafer_thickness, 0.775e-3);
}

TEST(Study, AnAngleTurnsACubicMaterial) {
  const std::string text = R"(
geometry = { disc = { diameter = "1 m", thickness = "1 mm" } }
material = { symmetry = "cubic", c11 = "165.7 GPa", c12 = "63.9 GPa", c44 = "79.6 GPa", density = "2329 kg/m^3", angle = "ANGLE" })";
  const auto stiffness = [&](const std::string& angle) {
    std::string own = text;
    return parsed(own.replace(own.find("ANGLE"), 5, angle)).materials[0].material.stiffness;
  };
  EXPECT_TRUE(stiffness("0 deg").isApprox(stiffness("90 deg"), 1e-12));
  EXPECT_NEAR(stiffness("45 deg")(0, 0) / 194.4e9, 1.0, 1e-9);  // (c11 + c12 + 2 c44) / 2
}

// --- What it refuses: each message has the line, the thing, what was found and what was expected.

TEST(StudyRefuses, AnUnknownKeyWithTheNearestName) {
  const auto message = refusal(changed("thickness = \"20 mm\"", "thicknes = \"20 mm\""));
  EXPECT_TRUE(says(message, "bench/study.toml:3:"));
  EXPECT_TRUE(
      says(message, "unknown key \"thicknes\" in geometry.plate; did you mean \"thickness\"?"));
  EXPECT_TRUE(says(message, "geometry.plate lacks \"thickness\""));
  EXPECT_TRUE(says(refusal(changed("[placement]", "[placment]")), "did you mean \"placement\"?"));
}

TEST(StudyRefuses, ABareNumberWhereAUnitIsDue) {
  const auto message = refusal(changed("\"70 GPa\"", "70"));
  EXPECT_TRUE(
      says(message, "material.youngs_modulus = 70 has no unit; expected a pressure such as"));
}

TEST(StudyRefuses, AWrongUnit) {
  EXPECT_TRUE(says(refusal(changed("\"20 mm\" } }", "\"20 kg\" } }")), "geometry.plate.thickness"));
  EXPECT_TRUE(says(refusal(changed("\"20 mm\" } }", "\"20 furlog\" } }")), "furlog"));
}

TEST(StudyRefuses, AWrongType) {
  EXPECT_TRUE(
      says(refusal(changed("count = 20", "count = \"20\"")), "modes.count is the text \"20\""));
  EXPECT_TRUE(says(refusal(changed("count = 20", "count = 2.5")), "expected a whole number"));
  EXPECT_TRUE(says(refusal(changed("poissons_ratio = 0.33", "poissons_ratio = true")), "is true"));
  EXPECT_TRUE(says(refusal(changed("mesh     = {", "mesh = 3 #")), "mesh is the number 3"));
}

TEST(StudyRefuses, ValuesThatCannotBe) {
  for (const auto* thickness : {"\"0 mm\"", "\"-20 mm\""}) {
    const auto message =
        refusal(changed("thickness = \"20 mm\"", std::string("thickness = ") + thickness));
    EXPECT_TRUE(says(message, "geometry.plate.thickness is "));
    EXPECT_TRUE(says(message, "expected more than 0"));
  }
  EXPECT_TRUE(says(refusal(changed("\"2700 kg/m^3\"", "\"0 kg/m^3\"")), "material.density is 0"));
  EXPECT_TRUE(
      says(refusal(changed("\"70 GPa\"", "\"-70 GPa\"")), "material.youngs_modulus is -70"));
  for (const auto* ratio : {"0.5", "-1", "0.7"}) {
    EXPECT_TRUE(says(refusal(changed("0.33", ratio)), "less than 0.5"));
  }
  EXPECT_FALSE(refusal(changed("\"600 mm\"", "\"nan mm\"")).empty());
  EXPECT_FALSE(refusal(changed("0.33", "nan")).empty());
  EXPECT_FALSE(refusal(changed("0.33", "inf")).empty());
}

TEST(StudyRefuses, DuplicateNamesWithBothLines) {
  const auto message = refusal(changed("name = \"s4\"", "name = \"s1\""));
  EXPECT_TRUE(says(message, "two sensors are called \"s1\": line 16 and line 22"));
}

TEST(StudyRefuses, AKeyTwice) {
  const auto message = refusal("title = \"a\"\ntitle = \"b\"\n");
  EXPECT_TRUE(says(message, "bench/study.toml:2:"));
}

TEST(StudyRefuses, TextThatIsNoToml) {
  EXPECT_TRUE(says(refusal("title = "), "bench/study.toml:1:"));
  EXPECT_FALSE(refusal(std::string("title = \"\xff\xfe\"")).empty());
  EXPECT_TRUE(says(refusal(""), "the study lacks \"geometry\""));
}

TEST(StudyRefuses, AllFaultsAtOnceInTheirOrder) {
  std::string text = changed("thickness = \"20 mm\"", "thicknes = \"20 mm\"");
  text.replace(text.find("count = 20"), 10, "count = -1");
  text.replace(text.find("\"1200 N/m\""), 10, "1200");
  const auto message = refusal(text);
  EXPECT_LT(message.find("thicknes"), message.find("modes.count"));
  EXPECT_LT(message.find("modes.count"), message.find("attachment[0].stiffness"));
}

TEST(StudyRefuses, NoMoreThanTwentyLines) {
  std::string text = kContract;
  for (int i = 0; i < 30; ++i) text += "[[sensor]]\n";
  const auto message = refusal(text);
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 20);
  EXPECT_TRUE(says(message, "and 70 more"));
}

TEST(StudyRefuses, DirectionsThatPointNowhere) {
  EXPECT_TRUE(says(refusal(changed("[0, 0, 2]", "[0, 0, 0]")), "three numbers that are not all 0"));
  EXPECT_TRUE(
      says(refusal(changed("[0, 0, 2]", "\"up\"")), "sensor[1].direction is the text \"up\""));
}

TEST(StudyRefuses, PathsThatLeaveTheFolder) {
  EXPECT_TRUE(
      says(refusal(changed("\"measured.uff\"", "\"../../etc/passwd\"")), "--allow-outside"));
  EXPECT_TRUE(says(refusal(changed("\"measured.uff\"", "\"/etc/passwd\"")), "--allow-outside"));
  const std::string inside = changed("\"measured.uff\"", "\"/opt/data/measured.uff\"");
  const study::Study study = study::parse_study(inside, "study.toml", {"/opt/data"});
  EXPECT_EQ(study.measurement->frf, "/opt/data/measured.uff");
}

TEST(StudyRefuses, ASymbolicLinkOutOfTheFolder) {
  const fs::path folder =
      fs::temp_directory_path() / ("chladni_study_test_link_" + std::to_string(getpid()));
  fs::remove_all(folder);
  fs::create_directories(folder);
  fs::create_symlink("/etc", folder / "inside");
  EXPECT_THROW(static_cast<void>(study::parse_study(
                   changed("\"measured.uff\"", "\"inside/passwd\""), folder / "study.toml")),
               InvalidInput);
  fs::remove_all(folder);
}

TEST(StudyRefuses, GeometryFilesThatAreMissingOrHaveNoUnit) {
  const std::string plate =
      R"({ plate = { length = "600 mm", width = "600 mm", thickness = "20 mm" } })";
  EXPECT_TRUE(says(refusal(changed(plate, R"({ file = "table.step" })")), "does not exist"));
  const fs::path folder =
      fs::temp_directory_path() / ("chladni_study_test_file_" + std::to_string(getpid()));
  fs::create_directories(folder);
  std::ofstream(folder / "table.stl") << "solid";
  const auto said = [&](const std::string& geometry) {
    try {
      static_cast<void>(study::parse_study(changed(plate, geometry), folder / "study.toml"));
    } catch (const InvalidInput& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_TRUE(says(said(R"({ file = "table.stl" })"), "geometry lacks \"unit\""));
  EXPECT_TRUE(says(said(R"({ file = "table.stl", unit = "kg" })"), "geometry.unit"));
  EXPECT_EQ(said(R"({ file = "table.stl", unit = "mm" })"), "");
  fs::remove_all(folder);
}

TEST(StudyRefuses, NoBodyOrTwo) {
  EXPECT_TRUE(
      says(refusal(changed("{ plate = { length = \"600 mm\", width = \"600 mm\", thickness = "
                           "\"20 mm\" } }",
                           "{ }")),
           "geometry holds 0 bodies"));
}

TEST(StudyRefuses, ExpectationsOfUnknownThings) {
  EXPECT_TRUE(says(refusal(changed("frequency_1 = {", "frequenzy_1 = {")),
                   "did you mean \"frequency_1\"?"));
  EXPECT_FALSE(refusal(changed("frequency_1 = {", "frequency_0 = {")).empty());
  EXPECT_TRUE(says(refusal(changed(", within = \"1 %\"", "")), "lacks \"within\""));
}

TEST(StudyRefuses, AStudyThatIsNoFile) {
  EXPECT_THROW(static_cast<void>(study::read_study("/nowhere/study.toml")), InvalidInput);
  EXPECT_THROW(static_cast<void>(study::read_study("/dev/zero")), InvalidInput);
  EXPECT_THROW(static_cast<void>(study::read_study("/")), InvalidInput);
}

TEST(StudyWarns, OfPrefixesLeftOut) {
  const auto warnings = [](const std::string& text) {
    std::string all;
    for (const auto& warning : parsed(text).warnings) all += warning + "\n";
    return all;
  };
  EXPECT_TRUE(says(warnings(changed("\"70 GPa\"", "\"70 Pa\"")), "youngs_modulus is 70 Pa"));
  EXPECT_TRUE(
      says(warnings(changed("\"2700 kg/m^3\"", "\"2.7 kg/m^3\"")), "density is 2.7 kg/m^3"));
  EXPECT_TRUE(says(warnings(changed("0.33", "0.47")), "poissons_ratio is above 0.45"));
}

TEST(Sha256, OfTheStandardsExamples) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

TEST(NearestName, ForgivesASlipAndNotMore) {
  EXPECT_EQ(study::nearest_name("thicknes", {"length", "width", "thickness"}), "thickness");
  EXPECT_EQ(study::nearest_name("lenght", {"length", "width"}), "length");
  EXPECT_EQ(study::nearest_name("colour", {"length", "width"}), "");
}

}  // namespace
}  // namespace chladni::study
