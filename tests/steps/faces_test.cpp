// On which faces priors, places and layouts are: the same whatever file the body came from.
#include "stage/faces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>

#include "base/error.h"
#include "mesh/bodies.h"
#include "steps/interpolation.h"
#include "steps/placement.h"
#include "steps/priors.h"
#include "tests/app/quiet_run.h"

namespace chladni::steps {
namespace {

constexpr double kLength = 120.0, kWidth = 80.0, kThickness = 6.0;  // [mm], of every block here

// Two triangles for each side of a box, low corner to high corner [mm].
std::string box_stl(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  constexpr int corners[12][3] = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                                  {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  std::ostringstream text;
  text << "solid block\n";
  for (const auto& triangle : corners) {
    text << "facet normal 0 0 0\nouter loop\n";
    for (const int i : triangle) {
      text << "vertex " << ((i & 1) != 0 ? high : low).x() << " " << ((i & 2) != 0 ? high : low).y()
           << " " << ((i & 4) != 0 ? high : low).z() << "\n";
    }
    text << "endloop\nendfacet\n";
  }
  return text.str() + "endsolid block\n";
}

// Any surface [mm].
std::string stl_of(const mesh::Surface& surface) {
  std::ostringstream text;
  text.precision(12);
  text << "solid body\n";
  for (const auto triangle : surface.triangles.rowwise()) {
    text << "facet normal 0 0 0\nouter loop\n";
    for (const int p : triangle) text << "vertex " << 1e3 * surface.points.row(p) << "\n";
    text << "endloop\nendfacet\n";
  }
  return text.str() + "endsolid body\n";
}

// Tetrahedra without any names, Gmsh 2.2 [mm].
std::string block_msh() {
  const auto body = mesh::layered(
      mesh::Plate{.length = kLength, .width = kWidth, .thickness = kThickness}, 12.0, 1);
  std::ostringstream text;
  text.precision(17);
  text << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" << body.node_count() << "\n";
  for (Eigen::Index i = 0; i < body.node_count(); ++i) {
    text << i + 1 << " " << body.points.row(i) << "\n";
  }
  text << "$EndNodes\n$Elements\n" << body.tet_count() << "\n";
  for (Eigen::Index t = 0; t < body.tet_count(); ++t) {
    text << t + 1 << " 4 0 " << (body.tets.row(t).array() + 1) << "\n";
  }
  return text.str() + "$EndElements\n";
}

const std::string kPlate =
    R"({ plate = { length = "120 mm", width = "80 mm", thickness = "6 mm" } })";
const std::string kStl = R"({ file = "block.stl", unit = "mm" })";
const std::string kMsh = R"({ file = "block.msh", unit = "mm" })";
const std::string kStep = R"({ file = "block.step" })";

const std::string kChannels = R"(
sensor = [
  { name = "s1", at = ["-52 mm", "33 mm"], direction = "z" },
  { name = "s2", at = ["50 mm", "31 mm"], direction = "z" },
  { name = "s3", at = ["44 mm", "-20 mm"], direction = "-z" },
]
actuator = [
  { name = "a1", at = ["-40 mm", "-30 mm"], direction = "z" },
  { name = "a2", at = ["5 mm", "8 mm"], direction = "z" },
]
)";

std::string text_of(const std::string& geometry, const std::string& rest) {
  return "title = \"block\"\ngeometry = " + geometry +
         "\nmaterial = { youngs_modulus = \"410 GPa\", poissons_ratio = 0.16, density = \"3150 "
         "kg/m^3\" }\nmesh = { edge_length = \"12 mm\", order = 3 }\n"
         "modes = { count = 8, damping_ratio = 0.005 }\n" +
         rest;
}

std::string upward_channels() {
  std::string text = kChannels;
  return text.replace(text.find("\"-z\""), 4, "\"z\"");
}

class OnFaces : public ::testing::Test {
 protected:
  void SetUp() override {
    setenv("CHLADNI_LIBEXEC", CHLADNI_BINARY_DIR "/bin", 1);
    const Eigen::Vector3d high(0.5 * kLength, 0.5 * kWidth, 0.0);
    write("block.stl", box_stl(-high - Eigen::Vector3d(0, 0, kThickness), high));
    write("block.msh", block_msh());
    std::filesystem::copy(CHLADNI_SOURCE_DIR "/tests/io/data/named_block.step",
                          folder_.path() / "block.step");
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
  }

  study::Study study_of(const std::string& geometry, const std::string& rest = "") const {
    return study::parse_study(text_of(geometry, rest), folder_.path() / "study.toml");
  }

  struct Found {
    steps::LearnedPriors priors;
    steps::BestPlaces placed;
  };
  Found found(const std::string& geometry, const std::string& rest) {
    const study::Study study = study_of(geometry, rest);
    app::QuietRun quiet(study, folder_.path() / "out");
    const stage::Solution solution = stage::solved(study, quiet.run());
    return {steps::learned_priors(study, solution, quiet.run()),
            steps::best_places(study, solution, quiet.run())};
  }

  std::string refusal(const std::string& geometry, const std::string& rest) {
    const study::Study study = study_of(geometry, rest);
    try {
      stage::require_faces(study, stage::outline_of(study).shell);
    } catch (const InvalidInput& e) {
      return e.what();
    }
    return "";
  }

  app::TestFolder folder_{"faces"};
};

testing::AssertionResult says(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "\"" << part << "\" is not in\n" << text;
}

void expect_same_priors(const steps::LearnedPriors& one, const steps::LearnedPriors& other) {
  ASSERT_EQ(one.columns, other.columns);
  for (std::size_t i = 0; i < one.columns.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const auto& a = one.last().per_mode[i];
    const auto& b = other.last().per_mode[i];
    EXPECT_NEAR(b.parameters(0) / a.parameters(0), 1.0, 0.05) << "length of mode " << i + 1;
    // Along the ridge sigma goes as a power of the length.
    EXPECT_NEAR(b.sigma / other.rms(k) / (a.sigma / one.rms(k)), 1.0, 0.2) << "sigma " << i + 1;
    EXPECT_NEAR(b.noise / other.rms(k) / (a.noise / one.rms(k)), 1.0, 0.2) << "noise " << i + 1;
    EXPECT_NEAR(other.rms(k) / one.rms(k), 1.0, 0.01) << "rms " << i + 1;
    EXPECT_NEAR(other.matched_length(k) / one.matched_length(k), 1.0, 0.03) << "matched " << i + 1;
    // Over the points of the surface, which TetGen spreads less evenly.
    EXPECT_NEAR(other.expected_error(k) / one.expected_error(k), 1.0, 0.1) << "error " << i + 1;
  }
  ASSERT_EQ(one.spline_error.size(), other.spline_error.size());
  for (std::size_t s = 0; s < one.spline_error.size(); ++s) {
    const Eigen::VectorXd off = other.spline_error[s].second - one.spline_error[s].second;
    EXPECT_LT(off.cwiseAbs().maxCoeff(), 0.03) << one.spline_error[s].first;
  }
}

void expect_same_places(const steps::BestPlaces& one, const steps::BestPlaces& other) {
  EXPECT_NEAR(one.surface.sites.area.sum(), other.surface.sites.area.sum(), 1e-9);
  ASSERT_FALSE(one.best.empty());
  ASSERT_FALSE(other.best.empty());
  EXPECT_NEAR(other.best[0].score / one.best[0].score, 1.0, 0.01);
  const Eigen::Array3d off = other.best[0].position.cwiseAbs() - one.best[0].position.cwiseAbs();
  EXPECT_LT(off.abs().maxCoeff(), 2e-3) << "but for the plate's symmetry";
  EXPECT_TRUE((other.surface.sites.position.col(2).array().abs() < 1e-9).all()) << "not on top";
  ASSERT_EQ(one.layouts.size(), other.layouts.size());
  const auto& a = one.layouts[0].scores;
  const auto& b = other.layouts[0].scores;
  for (Eigen::Index k = 0; k < a.size(); ++k) {
    if (std::isfinite(a(k))) {
      EXPECT_NEAR(b(k), a(k), 0.03 * std::abs(a(k))) << "layout score " << k;
    }
  }
  EXPECT_EQ(one.layouts[0].pairs, other.layouts[0].pairs);
  const double modes = static_cast<double>(one.wanted.columns.size());
  EXPECT_NEAR(std::exp((other.optima[0].choice.score - one.optima[0].choice.score) / modes), 1.0,
              0.05);
}

TEST_F(OnFaces, OneBlockIsTheSameInEveryFormat) {
  const std::string rest = kChannels + "[priors]\nsamples = [100]\nmodes = 4\n";
  const auto plate = found(kPlate, rest);
  EXPECT_TRUE(plate.placed.faces.notes.empty());
  std::vector<std::string> formats{kStl, kMsh};
#ifdef CHLADNI_WITH_STEP
  formats.push_back(kStep);
#endif
  for (const auto& format : formats) {
    SCOPED_TRACE(format);
    const auto other = found(format, rest);
    expect_same_priors(plate.priors, other.priors);
    expect_same_places(plate.placed, other.placed);
    ASSERT_EQ(other.placed.faces.notes.size(), 1U);
    EXPECT_TRUE(says(other.placed.faces.notes[0], "the face that looks along z, 96 cm2 of the 96"));
  }
}

TEST_F(OnFaces, ChannelsOfOtherDirectionsKillNothing) {
  std::string with_sides = kChannels;
  with_sides.insert(with_sides.find("]\nactuator"),
                    R"(  { name = "x1", at = ["60 mm", "0 mm", "-3 mm"], direction = "x" },
  { name = "y1", at = ["10 mm", "40 mm", "-3 mm"], direction = "y" },
)");
  const std::string priors = "[priors]\nsamples = [50]\nmodes = 3\n";
  const auto all = found(kPlate, with_sides + priors);
  const auto bare = found(kPlate, kChannels + priors);
  EXPECT_EQ(all.priors.matched_length, bare.priors.matched_length);
  EXPECT_EQ(all.priors.spline_error.size(), 3U);
  ASSERT_EQ(all.priors.notes.size(), 1U);
  EXPECT_TRUE(says(all.priors.notes[0], "x1, y1"));
}

// s3 measures along -z; told along z the same is learned.
TEST_F(OnFaces, TheSenseOfAChannelDoesNotMatter) {
  const std::string priors = "[priors]\nsamples = [50]\nmodes = 3\n";
  const auto down = found(kPlate, kChannels + priors).priors;
  const auto up = found(kPlate, upward_channels() + priors).priors;
  EXPECT_EQ(down.matched_length, up.matched_length);
  EXPECT_LT((down.last().channel_error - up.last().channel_error).norm(), 1e-12);
}

// No bottom edge and no ceiling of a pocket among the places for devices.
TEST_F(OnFaces, OfARibbedChuckFromAFileTheFaceSheetIsTaken) {
  const mesh::WaferTable chuck{.length = 0.3,
                               .width = 0.3,
                               .height = 0.012,
                               .face_sheet = 0.004,
                               .pockets_x = 6,
                               .pockets_y = 6,
                               .rib = 0.004,
                               .bores = {{{0.0, 0.09}, 0.01}, {{0.08, -0.05}, 0.01}}};
  write("chuck.stl", stl_of(mesh::surface(chuck, 0.01)));
  const study::Study study = study_of("{ file = \"chuck.stl\", unit = \"mm\" }");
  const auto shell = stage::outline_of(study).shell;
  const auto faces = stage::faces_of(study, shell, {}, "placement.on");
  ASSERT_EQ(std::ssize(faces.looking), shell.faces.rows());
  EXPECT_EQ(faces.direction, Eigen::Vector3d::UnitZ().eval());
  double area = 0.0;
  for (Eigen::Index f = 0; f < shell.faces.rows(); ++f) {
    if (faces.looking[static_cast<std::size_t>(f)] == 0) continue;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(shell.points(shell.faces(f, k), 2), 0.0, 1e-9);
    area += mesh::area(shell.points, shell.faces.row(f));
  }
  EXPECT_NEAR(area, 0.09 - 2.0 * std::numbers::pi * 25e-6, 1e-6);
}

TEST_F(OnFaces, ASideIsLookedAtWhereItIsAskedFor) {
  const auto side = found(kStl, R"([priors]
samples = [50]
modes = 2
on = { facing = "y" }
[placement]
modes = 1
on = { facing = [0, 1, 0] }
)");
  EXPECT_NEAR(side.priors.surface.sites.area.sum(), 120e-3 * 6e-3, 1e-9);
  EXPECT_EQ(side.priors.plan.direction, Eigen::Vector3d::UnitY().eval());
  for (const auto& pair : side.placed.best) EXPECT_NEAR(pair.position.y(), 0.04, 1e-9);
}

TEST_F(OnFaces, InterpolationFromAFileTakesAllUsualMethods) {
  write("real.toml", text_of(kPlate, upward_channels()));
  const study::Study study =
      study_of(kStl, upward_channels() + "[measurement]\ntruth = \"real.toml\"\nmodes = 3\n");
  app::QuietRun quiet(study, folder_.path() / "out");
  const stage::Solution solution = stage::solved(study, quiet.run());
  const auto result = steps::interpolated(study, solution, quiet.run());
  ASSERT_EQ(result.methods.size(), 3U) << quiet.said();
  EXPECT_LT(result.methods[0].error(0), 0.01);
}

TEST_F(OnFaces, WhereNothingLooksUpAllOfTheSurfaceIsTakenAndSaid) {
  const study::Study ball = study_of("{ sphere = { diameter = \"60 mm\" } }");
  const auto faces = stage::faces_of(ball, stage::outline_of(ball).shell, {}, "priors.on");
  EXPECT_TRUE(faces.looking.empty());
  EXPECT_TRUE(faces.patches.empty());
  EXPECT_FALSE(faces.direction.has_value());
}

// A plate that stands: what looks up is its rim, and that is said.
TEST_F(OnFaces, APlateThatStandsIsToldOf) {
  write("block.stl", box_stl({0, 0, 0}, {120, 6, 80}));
  const study::Study study = study_of(kStl);
  const auto faces = stage::faces_of(study, stage::outline_of(study).shell, {}, "priors.on");
  ASSERT_EQ(faces.notes.size(), 2U);
  EXPECT_TRUE(says(faces.notes[1], "on = { facing = \"y\" }"));
}

TEST_F(OnFaces, PatchesThatAreNotThereAreToldAllAtOnceWithTheirLines) {
  const std::string text = refusal(kPlate, R"([[support]]
patch = "botom"
fixed = "z"
[placement]
on = ["lid"]
keep_out = ["top", "hole"]
[priors]
on = ["x_max", "x_mx"]
[interpolation]
on = ["top"]
)");
  EXPECT_TRUE(says(text, "study.toml:6:1: support.patch: the body has no patch \"botom\""));
  EXPECT_TRUE(says(text, "did you mean \"bottom\"?"));
  EXPECT_TRUE(says(text, "study.toml:10:6: placement.on: the body has no patch \"lid\""));
  EXPECT_TRUE(says(text, "study.toml:11:20: placement.keep_out: the body has no patch \"hole\""));
  EXPECT_TRUE(says(text, "study.toml:13:6: priors.on: the body has no patch \"x_mx\""));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3) << text;
}

TEST_F(OnFaces, ARegionOfAnObserverHasPatchesThatAreThere) {
  EXPECT_TRUE(says(refusal(kPlate, R"([placement]
observer = { region = [{ patch = "lid" }], sensors = 2 }
[observer]
noise = "1 nm"
sample_rate = "5 kHz"
[[observer.disturbance]]
name = "d"
kind = "actuators"
rms = "0.1 N"
)"),
                   "placement.observer.region: the body has no patch \"lid\""));
}

TEST_F(OnFaces, APatchOfAStlIsFoundByAngle) {
  EXPECT_EQ(refusal(kStl, "[placement]\non = [\"top\", \"x_max\"]\n"), "");
  EXPECT_TRUE(says(refusal(kStl, "[placement]\non = [\"surface\"]\n"),
                   "there are: top, bottom, x_min, x_max, y_min, y_max"));
}

TEST_F(OnFaces, AStepKeepsTheNamesOfItsFaces) {
#ifndef CHLADNI_WITH_STEP
  GTEST_SKIP() << "built without OpenCASCADE";
#endif
  EXPECT_EQ(refusal(kStep, "[placement]\non = [\"clamp face\"]\nkeep_out = [\"seat\"]\n"), "");
  EXPECT_TRUE(says(refusal(kStep, "[placement]\non = [\"clamp\"]\n"), "clamp face"));
}

TEST(FacePlan, RefusesWhatCannotBeMeant) {
  const auto refused = [](const std::string& on) -> std::string {
    try {
      (void)study::parse_study(text_of(kPlate, "[placement]\non = " + on + "\n"), "study.toml");
    } catch (const InvalidInput& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_TRUE(says(refused("{ facing = \"up\" }"), "\"x\", \"y\", \"z\""));
  EXPECT_TRUE(says(refused("{ looking = \"z\" }"), "facing"));
  EXPECT_TRUE(says(refused("\"top\""), "[\"top\"]"));
  EXPECT_TRUE(says(refused("[3]"), "expected a text"));
  EXPECT_EQ(refused("{ facing = \"-z\" }"), "");
}

}  // namespace
}  // namespace chladni::steps
