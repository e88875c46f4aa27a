// Materials by name, arrays of devices and mounts: what they stand for.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>

#include "study/device_arrays.h"
#include "study/named_materials.h"
#include "study/origin.h"
#include "tests/refusal.h"

namespace chladni::study {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr const char* kGeometry =
    "geometry = { plate = { length = \"400 mm\", width = \"300 mm\", thickness = \"12 mm\" } }\n";
constexpr const char* kSteel = "material = \"steel\"\n";

Study with(const std::string& text, const std::string& material = kSteel) {
  return parse_study(material + kGeometry + text, "plate.toml");
}

std::string refusal_with(const std::string& text, const std::string& material = kSteel) {
  return refusal_of([&] { return with(text, material); });
}

bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// ---- materials

TEST(NamedMaterials, AreEachAStudyOfTheirOwnAndHaveASource) {
  std::set<std::string_view> names;
  for (const auto& one : named_materials()) {
    EXPECT_TRUE(names.insert(one.name).second) << one.name;
    EXPECT_GT(one.source.size(), 10U) << one.name;
    const auto study = with("", "material = \"" + std::string(one.name) + "\"\n");
    EXPECT_TRUE(study.warnings.empty()) << one.name;
    EXPECT_EQ(study.materials.front().symmetry, one.symmetry);
    EXPECT_GT(study.materials.front().material.density, 1000.0);
    const Eigen::Matrix<double, 6, 6> c = study.materials.front().material.stiffness;
    EXPECT_GT(c(0, 0), 50e9) << one.name;
    EXPECT_LT(c(0, 0), 600e9) << one.name;
  }
}

TEST(NamedMaterials, HaveTheConstantsOfTheirNames) {
  const auto named = with("", "material = \"steel\"\n").materials.front();
  const auto written =
      with("",
           "material = { youngs_modulus = \"210 GPa\", poissons_ratio = 0.3, density = \"7850 "
           "kg/m^3\" }\n")
          .materials.front();
  EXPECT_EQ(named.material.stiffness, written.material.stiffness);
  EXPECT_EQ(named.material.density, written.material.density);
}

TEST(NamedMaterials, AreFoundInAnySpelling) {
  for (const auto* name : {"Zerodur", "ZERODUR"}) EXPECT_NE(named_material(name), nullptr) << name;
  EXPECT_EQ(named_material("Aluminum-6061"), named_material("aluminium 6061"));
  EXPECT_EQ(named_material("aluminium"), nullptr);
}

TEST(NamedMaterials, MayBeChanged) {
  const auto study =
      with("", "material = { name = \"steel\", density = \"7900 kg/m^3\", angle = \"10 deg\" }\n");
  EXPECT_EQ(study.materials.front().material.density, 7900.0);
  EXPECT_TRUE(study.materials.front().is_turned);
  const auto base = fs::temp_directory_path() / ("chladni_named_" + std::to_string(getpid()));
  fs::create_directories(base);
  std::ofstream(base / "base.toml") << kSteel << kGeometry;
  const auto heavier = parse_study("extends = \"base.toml\"\nmaterial.density = \"9000 kg/m^3\"\n",
                                   base / "heavier.toml");
  EXPECT_EQ(heavier.materials.front().material.density, 9000.0);
  EXPECT_NEAR(heavier.materials.front().constants.front().second, 210e9, 1.0);
  fs::remove_all(base);
}

TEST(NamedMaterials, ThatAreNotKnownGetTheNearestName) {
  const auto said = refusal_with("", "material = \"zerodor\"\n");
  EXPECT_TRUE(says(said,
                   "plate.toml:1:12: material \"zerodor\" is not known; did you mean "
                   "\"zerodur\"?"))
      << said;
  EXPECT_FALSE(says(said, "lacks")) << said;
  EXPECT_TRUE(
      says(refusal_with("", "material = { name = \"silicon\", symmetry = \"isotropic\" }\n"),
           "is cubic"));
}

// ---- arrays

std::vector<Vector2d> sensors_of(const Study& study) {
  std::vector<Vector2d> places;
  for (const auto& sensor : study.sensors) places.emplace_back(sensor.at.point.head<2>());
  return places;
}

std::string sensor(const std::string& at, const std::string& more = "") {
  return "[[sensor]]\nname = \"s\"\nat = " + at + "\ndirection = \"z\"\n" + more;
}

TEST(DeviceArrays, OfARingAreEvenlySpacedOnIt) {
  const auto study = with(sensor(
      R"({ ring = { count = 12, radius = "85 mm", start = "15 deg", centre = ["10 mm", "-5 mm"] } })"));
  ASSERT_EQ(study.sensors.size(), 12U);
  const Vector2d centre(0.010, -0.005);
  const auto places = sensors_of(study);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(study.sensors[i].name, "s" + std::to_string(i + 1));
    EXPECT_NEAR((places[i] - centre).norm(), 0.085, 1e-11);
    EXPECT_NEAR((places[i] - places[(i + 1) % 12]).norm(), 2 * 0.085 * std::sin(M_PI / 12), 1e-11);
  }
  EXPECT_NEAR(places[0].y() - centre.y(), 0.085 * std::sin(M_PI / 12), 1e-11);
  EXPECT_TRUE(study.sensors[0].at.from_above);
}

TEST(DeviceArrays, OfAGridHaveItsPitchAndItsCentre) {
  const auto places = sensors_of(with(sensor(
      R"({ grid = { pitch = ["60 mm", "40 mm"], columns = 4, rows = 3, centre = ["5 mm", "0 mm"] } })")));
  ASSERT_EQ(places.size(), 12U);
  Vector2d mean = Vector2d::Zero();
  for (const auto& place : places) mean += place / 12.0;
  EXPECT_LT((mean - Vector2d(0.005, 0.0)).norm(), 1e-12);
  EXPECT_LT((places[1] - places[0] - Vector2d(0.060, 0.0)).norm(), 1e-12);
  EXPECT_LT((places[4] - places[0] - Vector2d(0.0, 0.040)).norm(), 1e-12);
}

// A lattice: 1 + 3 n (n + 1) places, each but the outer ones with six neighbours at the pitch.
TEST(DeviceArrays, OfAHexagonAreALattice) {
  for (int rings = 0; rings <= 3; ++rings) {
    const auto all = places(HexagonPlan{.rings = rings, .pitch = 0.02, .start = 0.3, .centre = {}});
    ASSERT_EQ(static_cast<int>(all.size()), 1 + 3 * rings * (rings + 1));
    int inner = 0;
    for (const auto& place : all) {
      const auto near = std::ranges::count_if(all, [&](const Vector2d& other) {
        const double distance = (other - place).norm();
        EXPECT_TRUE(distance < 1e-12 || distance > 0.02 - 1e-12);
        return std::abs(distance - 0.02) < 1e-12;
      });
      inner += near == 6 ? 1 : 0;
    }
    EXPECT_EQ(inner, rings > 0 ? 1 + 3 * rings * (rings - 1) : 0);
  }
}

TEST(DeviceArrays, CountNodesAndKeepAllOtherKeys) {
  const auto study = with(sensor(R"({ ring = { count = 3, radius = "50 mm" }, z = "-12 mm" })",
                                 "quantity = \"velocity\"\nnode = 101\n"));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(study.sensors[i].node, 101 + static_cast<long long>(i));
    EXPECT_EQ(study.sensors[i].quantity, "velocity");
    EXPECT_FALSE(study.sensors[i].at.from_above);
    EXPECT_EQ(study.sensors[i].at.point.z(), -0.012);
  }
}

TEST(DeviceArrays, AreChangedElementByElement) {
  const auto study = with(sensor(R"({ ring = { count = 4, radius = "50 mm" } })") +
                          "[[sensor]]\nname = \"s2\"\ngain = 1.5\n"
                          "[[sensor]]\nname = \"s3\"\nremoved = true\n" +
                          "[[layout]]\nname = \"all\"\nsensors = [\"s\"]\nactuators = []\n");
  ASSERT_EQ(study.sensors.size(), 3U);
  EXPECT_EQ(study.sensors[1].gain, 1.5);
  EXPECT_EQ(study.sensors[2].name, "s4");
  EXPECT_EQ(study.layouts.front().sensors, (std::vector<std::string>{"s1", "s2", "s4"}));
}

TEST(DeviceArrays, StandForTheirElementsInLayouts) {
  const auto study = with(sensor(R"({ ring = { count = 3, radius = "50 mm" } })") +
                          "[[actuator]]\nname = \"a\"\nat = { grid = { pitch = \"50 mm\", columns "
                          "= 2, rows = 1 } }\ndirection = \"z\"\n"
                          "[[layout]]\nname = \"all\"\nsensors = [\"s\"]\nactuators = [\"a2\"]\n"
                          "[measurement]\nfrf = \"m.csv\"\nhold_out = [\"a\", \"s1\"]\n");
  EXPECT_EQ(study.layouts.front().sensors, (std::vector<std::string>{"s1", "s2", "s3"}));
  EXPECT_EQ(study.layouts.front().actuators, (std::vector<std::string>{"a2"}));
  EXPECT_EQ(study.measurement->hold_out, (std::vector<std::string>{"a1", "a2", "s1"}));
}

// The text that a diagnosis extends has the elements; read again, it is the same study.
TEST(DeviceArrays, AreWrittenOutInTheStudysText) {
  const auto study = with(sensor(R"({ hexagon = { rings = 1, pitch = "30 mm" } })"));
  const auto again = parse_study(study.text, "plate.toml");
  ASSERT_EQ(again.sensors.size(), 7U);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_EQ(again.sensors[i].at.point, study.sensors[i].at.point);
  }
}

TEST(DeviceArrays, AreExtendedAndFound) {
  const auto folder = fs::temp_directory_path() / ("chladni_arrays_" + std::to_string(getpid()));
  fs::create_directories(folder / "data");
  std::ofstream(folder / "data/places.csv")
      << "name,x_mm,y_mm\n# corners\nfl,-100,-50\nfr,100,-50\n";
  std::ofstream(folder / "data/base.toml")
      << kSteel << kGeometry << sensor("{ csv = \"places.csv\" }");
  const auto study =
      parse_study("extends = \"data/base.toml\"\n[[sensor]]\nname = \"fr\"\nremoved = true\n",
                  folder / "variant.toml");
  ASSERT_EQ(study.sensors.size(), 1U);
  EXPECT_EQ(study.sensors[0].name, "fl");
  EXPECT_EQ(study.sensors[0].at.point, Vector3d(-0.1, -0.05, 0.0));
  const auto files = named_files(study, false);
  EXPECT_TRUE(
      std::ranges::any_of(files, [](const auto& one) { return one.name == "data/places.csv"; }));
  const auto more = parse_study(
      "extends = \"data/ring.toml\"\nsensor = [{ name = \"s\", at = { ring = { count = 5 } } }]\n",
      [&] {
        std::ofstream(folder / "data/ring.toml")
            << kSteel << kGeometry << sensor(R"({ ring = { count = 3, radius = "20 mm" } })");
        return folder / "five.toml";
      }());
  EXPECT_EQ(more.sensors.size(), 5U);
  fs::remove_all(folder);
}

TEST(DeviceArrays, OfCsvFilesSayWhatIsWrongAndWhere) {
  const auto folder = fs::temp_directory_path() / ("chladni_csv_" + std::to_string(getpid()));
  fs::create_directories(folder);
  const auto said = [&](const std::string& csv) {
    std::ofstream(folder / "places.csv") << csv;
    return refusal_of([&] {
      return parse_study(kSteel + std::string(kGeometry) + sensor("{ csv = \"places.csv\" }"),
                         folder / "study.toml");
    });
  };
  EXPECT_TRUE(says(said(""), "no places"));
  EXPECT_TRUE(says(said("name,x_mm,y_mm\n"), "no places"));
  EXPECT_TRUE(says(said("x,y\n1,2\n"), "places.csv:1: a column \"x\""));
  EXPECT_TRUE(says(said("x_mm,y_kg\n1,2\n"), "kg"));
  EXPECT_TRUE(says(said("x_mm\n1\n"), "no columns for x and y"));
  EXPECT_TRUE(says(said("x_mm,y_mm,x_in\n1,2,3\n"), "two columns of x"));
  EXPECT_TRUE(says(said("x_mm,y_mm\n1,2\n3\n"), "places.csv:3: 1 values; expected 2"));
  EXPECT_TRUE(says(said("x_mm,y_mm\n1,two\n"), "places.csv:2: \"two\" is no number"));
  EXPECT_TRUE(says(said("x_mm,y_mm\n1,nan\n"), "no number"));
  EXPECT_TRUE(says(said("name,x_mm,y_mm\na,1,2\na,3,4\n"), "two sensors are called \"a\""));
  EXPECT_EQ(said("\xef\xbb\xbfx_mm, y_cm\r\n1, 2\r\n"), "");
  fs::remove_all(folder);
  EXPECT_TRUE(says(refusal_with(sensor("{ csv = \"/etc/passwd\" }")), "leaves the study's folder"));
  EXPECT_TRUE(says(refusal_with(sensor("{ csv = \"none.csv\" }")), "none.csv"));
}

TEST(DeviceArrays, SayWhatTheyExpect) {
  EXPECT_TRUE(says(refusal_with(sensor("{ circle = { count = 3 } }")),
                   "plate.toml:5:6: sensor.at is a table; expected one of ring, grid"));
  EXPECT_TRUE(says(refusal_with(sensor(R"({ ring = { radius = "5 mm" } })")), "lacks \"count\""));
  EXPECT_TRUE(says(refusal_with(sensor("{ ring = { count = 3 } }")), "lacks \"radius\""));
  EXPECT_FALSE(says(refusal_with(sensor("{ ring = { count = 3 } }")), "nan"));
  EXPECT_TRUE(says(refusal_with(sensor(R"({ ring = { count = 3, radius = "5 kg" } })")), "5 kg"));
  EXPECT_TRUE(says(refusal_with(sensor(R"({ ring = { count = 3, radius = "5 mm", cuont = 1 } })")),
                   "cuont"));
  EXPECT_TRUE(says(refusal_with(sensor(R"({ ring = { count = 3, radius = "5 mm" } })") +
                                "[[sensor]]\nname = \"t9\"\nremoved = true\n"),
                   "to be removed"));
  EXPECT_TRUE(says(refusal_with("[[sensor]]\nat = { ring = { count = 3, radius = \"5 mm\" } }\n"),
                   "lacks \"name\""));
}

// ---- mounts

std::string attachment(const std::string& kind, const std::string& keys) {
  return "[[attachment]]\nkind = \"" + kind + "\"\nname = \"m\"\n" + keys;
}

const fem::GroundSpring& spring(const AttachmentPlan& plan) {
  return std::get<fem::GroundSpring>(plan.what);
}

TEST(KinematicMounts, HoldAlongZAndAcrossTheirGrooves) {
  const auto study = with(attachment("kinematic_mount", R"(
at = { ring = { count = 3, radius = "100 mm" } }
stiffness = "20 N/um"
lateral_stiffness = "5 N/um"
)"));
  ASSERT_EQ(study.attachments.size(), 6U);
  Eigen::Matrix<double, 6, 6> stiffness = Eigen::Matrix<double, 6, 6>::Zero();
  for (const auto& plan : study.attachments) {
    const auto& one = spring(plan);
    Eigen::Matrix<double, 6, 1> form;
    const Vector3d p = plan.at.point;
    form << one.direction, p.cross(one.direction);
    stiffness += one.stiffness * form * form.transpose();
    if (std::abs(one.direction.z()) < 0.5) {
      EXPECT_NEAR(one.direction.dot(p.normalized()), 0.0, 1e-9) << "free towards the centre";
    }
  }
  // Closed forms of three grooves towards one centre: exactly six constraints, alike along x and y.
  const double k = 20e6;
  const double t = 5e6;
  const double r = 0.1;
  Eigen::Matrix<double, 6, 1> expected;
  expected << 1.5 * t, 1.5 * t, 3 * k, 1.5 * k * r * r, 1.5 * k * r * r, 3 * t * r * r;
  EXPECT_LT((stiffness.diagonal() - expected).cwiseAbs().maxCoeff(), 1e-6 * k);
  EXPECT_EQ(stiffness.fullPivLu().rank(), 6);
}

TEST(KinematicMounts, AloneNeedAGroove) {
  const std::string keys = "at = [\"10 mm\", \"0 mm\"]\nstiffness = \"20 N/um\"\n";
  EXPECT_TRUE(says(refusal_with(attachment("kinematic_mount", keys)), "lacks \"groove\""));
  const auto study = with(attachment("kinematic_mount", keys + "groove = \"x\"\n"));
  ASSERT_EQ(study.attachments.size(), 2U);
  EXPECT_EQ(study.attachments[0].name, "m_z");
  EXPECT_EQ(study.attachments[1].name, "m_t");
  EXPECT_NEAR(std::abs(spring(study.attachments[1]).direction.y()), 1.0, 1e-12);
  EXPECT_EQ(spring(study.attachments[1]).stiffness, 20e6) << "as along z";
  EXPECT_TRUE(says(refusal_with(attachment("kinematic_mount",
                                           "stiffness = \"20 N/um\"\ngroove = "
                                           "\"x\"\n")),
                   "lacks \"at\""));
  EXPECT_TRUE(says(refusal_with(attachment("kinematic_mount", keys + "grove = \"x\"\n")), "grove"));
}

// A pad of uniform stiffness: k along its direction, k r²/4 against tilting about any axis.
TEST(AirBearings, HaveTheStiffnessOfTheirPad) {
  for (const std::string at : {R"(["30 mm", "20 mm"])", R"(["30 mm", "20 mm", "-12 mm"])"}) {
    const auto study = with(attachment(
        "air_bearing",
        "at = " + at +
            "\nstiffness = \"12 N/um\"\ndamping = \"60 N s/m\"\ndiameter = \"40 mm\"\n"));
    double k = 0.0;
    double c = 0.0;
    Eigen::Matrix2d tilt = Eigen::Matrix2d::Zero();
    Vector2d shift = Vector2d::Zero();
    for (const auto& plan : study.attachments) {
      const Vector2d off = plan.at.point.head<2>() - Vector2d(0.030, 0.020);
      EXPECT_EQ(spring(plan).direction, Vector3d::UnitZ());
      k += spring(plan).stiffness;
      c += spring(plan).damping;
      tilt += spring(plan).stiffness * off * off.transpose();
      shift += spring(plan).stiffness * off;
    }
    EXPECT_NEAR(k, 12e6, 1e-3);
    EXPECT_NEAR(c, 60.0, 1e-9);
    EXPECT_LT(shift.norm(), 1e-3);
    const double expected = 12e6 * 0.02 * 0.02 / 4.0;
    EXPECT_LT((tilt - expected * Eigen::Matrix2d::Identity()).cwiseAbs().maxCoeff(),
              1e-6 * expected);
  }
}

TEST(AirBearings, AlongAnotherAxisLieInItsPlane) {
  const auto study = with(attachment("air_bearing", R"(
at = ["200 mm", "0 mm", "-6 mm"]
direction = "x"
stiffness = "12 N/um"
diameter = "8 mm"
)"));
  ASSERT_EQ(study.attachments.size(), 6U);
  for (const auto& plan : study.attachments) {
    EXPECT_NEAR(plan.at.point.x(), 0.2, 1e-12);
    EXPECT_NEAR((plan.at.point - Vector3d(0.2, 0.0, -0.006)).norm(), 0.004 / std::sqrt(2.0), 1e-11);
    EXPECT_EQ(spring(plan).direction, Vector3d::UnitX());
  }
  EXPECT_TRUE(says(refusal_with(attachment("air_bearing",
                                           "at = [\"0 mm\", \"0 mm\"]\ndirection = \"x\"\n"
                                           "stiffness = \"12 N/um\"\ndiameter = \"8 mm\"\n")),
                   "three lengths"));
  EXPECT_TRUE(says(refusal_with(attachment("air_bearing", "at = [\"0 mm\", \"0 mm\"]\n")),
                   "lacks \"stiffness\""));
}

}  // namespace
}  // namespace chladni::study
