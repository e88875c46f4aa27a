// A diagnosis looks at the faces that `on` names, by the rule of placement and priors.
#include "stage/diagnosis_faces.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <memory>

#include "base/error.h"
#include "rotation/turn.h"
#include "stage/diagnosis_structure.h"
#include "stage/faces.h"
#include "tests/app/quiet_run.h"

namespace chladni::stage {
namespace {

const std::string kMaterial =
    "material = { youngs_modulus = \"70 GPa\", poissons_ratio = 0.33, density = \"2700 kg/m^3\" }\n"
    "mesh = { edge_length = \"50 mm\", order = 2 }\n"
    "modes = { count = 12, damping_ratio = 0.005 }\n";
const std::string kPlate =
    "geometry = { plate = { length = \"600 mm\", width = \"400 mm\", thickness = \"10 mm\" } }\n" +
    kMaterial;

std::string channels(double x_mm, double y_mm) {
  const auto at = fmt::format("at = [\"{} mm\", \"{} mm\"]\ndirection = \"z\"\n", x_mm, y_mm);
  return "[[sensor]]\nname = \"s\"\n" + at + "[[actuator]]\nname = \"a\"\n" + at;
}

struct Solved {
  study::Study study;
  stage::Solution solution;

  [[nodiscard]] diagnosis::Structure structure() const {
    return stage::structure_of(study, solution);
  }
  [[nodiscard]] stage::DiagnosedFaces faces() const {
    return stage::diagnosed_faces(study, solution.model.body);
  }
};

Solved solved_with(const std::string& text) {
  const app::TestFolder folder("diagnosis_faces");
  study::Study study = study::parse_study(text, "study.toml");
  app::QuietRun quiet(study, folder.path());
  auto solution = stage::solved(study, quiet.run());
  return {std::move(study), std::move(solution)};
}

const Solved& plate() {
  static const Solved made = solved_with(kPlate + channels(-131.0, 77.0));
  return made;
}

Solved looking(const std::string& on) {
  auto other = plate();
  other.study = study::parse_study(
      kPlate + channels(-131.0, 77.0) + "[diagnosis]\non = " + on + "\n", "study.toml");
  return other;
}

TEST(DiagnosisFaces, AreTheTopWhereNothingIsSaid) {
  const auto faces = plate().faces();
  EXPECT_EQ(faces.chart.axes, Eigen::Matrix3d::Identity());
  EXPECT_EQ(faces.chart.origin, Eigen::Vector3d::Zero());
  EXPECT_TRUE(faces.notes.empty());
  EXPECT_TRUE(stage::has_the_axes_of_variations(faces.chart, plate().solution.model.body));
}

// The same body seen from behind: v is turned, motions along −z.
TEST(DiagnosisFaces, MayBeSeenFromBehind) {
  const auto below = looking("{ facing = \"-z\" }");
  const auto faces = below.faces();
  EXPECT_EQ(faces.chart.axes.col(2), -Eigen::Vector3d::UnitZ());
  EXPECT_EQ(faces.chart.axes.col(1), -Eigen::Vector3d::UnitY());
  EXPECT_NEAR(faces.chart.axes.determinant(), 1.0, 1e-15);
  EXPECT_EQ(faces.notes.size(), 1U);
  EXPECT_FALSE(stage::has_the_axes_of_variations(faces.chart, below.solution.model.body));
  const auto down = below.structure();
  const auto up = plate().structure();
  EXPECT_LT((down.surface.in_body({0.1, 0.05}) - Eigen::Vector3d(0.1, -0.05, -0.01)).norm(), 1e-12);
  const auto there = down.surface.at({0.1, 0.05});
  const auto here = up.surface.at({0.1, -0.05});
  ASSERT_TRUE(there && here);
  // Both sides of a thin plate move alike.
  EXPECT_LT((there->shape + here->shape).norm(), 1e-2 * here->shape.norm());
  EXPECT_LT((there->slope_v - here->slope_v).norm(), 1e-2 * here->slope_v.norm());
  EXPECT_EQ(down.bending_power, 3.0);
  EXPECT_NEAR(down.thickness, up.thickness, 1e-12);
  EXPECT_LT((down.directional.along_u - up.directional.along_u).norm(),
            1e-9 * up.directional.along_u.norm());
  EXPECT_LT((down.directional.shear - up.directional.shear).norm(),
            1e-9 * up.directional.shear.norm());
}

TEST(DiagnosisFaces, MayBeARim) {
  const auto rim = looking("[\"x_max\"]");
  const auto faces = rim.faces();
  EXPECT_EQ(faces.chart.axes.col(2), Eigen::Vector3d::UnitX());
  EXPECT_NEAR(faces.chart.height, 0.6, 1e-12);
  const auto made = rim.structure();
  EXPECT_EQ(made.bending_power, 0.0);
  EXPECT_NEAR(made.surface.area.sum(), 0.4 * 0.01, 1e-9);
  EXPECT_NEAR(made.surface.in_body(made.surface.places.row(0)).x(), 0.3, 1e-12);
}

TEST(DiagnosisFaces, ThatAreNotThereAreRefusedByTheirLine) {
  const auto wrong = looking("[\"tpo\"]");
  try {
    stage::require_faces(wrong.study, wrong.solution.model.body);
    FAIL() << "it is refused";
  } catch (const InvalidInput& e) {
    EXPECT_NE(std::string(e.what()).find("study.toml:14:6: diagnosis.on: the body has no patch "
                                         "\"tpo\", did you mean \"top\"?"),
              std::string::npos)
        << e.what();
  }
}

// A beam that stands on its narrow side: its top is looked at, as by placement, not its flank.
TEST(DiagnosisFaces, OfAStandingBeamAreItsTop) {
  const auto beam = solved_with(
      "geometry = { beam = { length = \"500 mm\", width = \"10 mm\", thickness = \"30 mm\" } }\n" +
      kMaterial + channels(-200.0, 0.0));
  const auto faces = beam.faces();
  EXPECT_EQ(faces.chart.axes.col(2), Eigen::Vector3d::UnitZ());
  EXPECT_NEAR(faces.chart.height, 0.03, 1e-12);
  const auto made = beam.structure();
  const auto at = made.surface.at({-0.2, 0.0});
  ASSERT_TRUE(at.has_value());
  EXPECT_LT((at->shape.transpose() - made.outputs.shapes.row(0)).norm(), 1e-9);
}

// A wafer lies on the middle of the table: causes are sought on it too, unless patches are named.
TEST(DiagnosisFaces, LeaveOutWhatIsNoneOfThem) {
  EVERY_FOURTH_LANDING();
  auto table = solved_with(
      "[geometry.wafer_table]\nlength = \"200 mm\"\nwidth = \"200 mm\"\nheight = \"30 mm\"\n"
      "pockets = [0, 0]\nface_sheet = \"30 mm\"\n"
      "wafer = { diameter = \"100 mm\", thickness = \"4 mm\" }\n"
      "[material]\nyoungs_modulus = \"70 GPa\"\npoissons_ratio = 0.33\n"
      "density = \"2700 kg/m^3\"\n[mesh]\nedge_length = \"30 mm\"\n[modes]\ncount = 4\n" +
      channels(70.0, 70.0));
  const auto upper = [&] {
    const auto faces = table.faces();
    return std::make_unique<stage::UpperFace>(faces.chart, table.solution.model.body,
                                              table.solution.modes.shapes, stage::ModesAbove{},
                                              faces.chosen);
  };
  EXPECT_TRUE(upper()->holds({0.02, 0.03}));
  EXPECT_TRUE(upper()->holds({0.07, 0.07}));
  table.study.diagnosis.emplace().on.patches = {"top"};
  EXPECT_FALSE(upper()->holds({0.02, 0.03}));
  EXPECT_FALSE(upper()->at({0.02, 0.03}).has_value());
  EXPECT_TRUE(upper()->holds({0.07, 0.07}));
}

// Model and modes as they would be of a body that leans by 20 degrees about x.
Solved leaning() {
  auto other = looking("{ facing = [0, -0.3420201433256687, 0.9396926207859084] }");
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(20.0 * std::acos(-1.0) / 180.0, Eigen::Vector3d::UnitX()).matrix();
  auto& model = other.solution.model;
  model.body.points = (model.body.points * turn.transpose()).eval();
  for (auto* sites : {&model.sensors, &model.actuators}) {
    for (auto& site : *sites) {
      site.position = turn * site.position;
      site.normal = turn * site.normal;
    }
  }
  for (auto* all : {&other.study.sensors, &other.study.actuators}) {
    for (auto& one : *all) one.direction = turn * one.direction;
  }
  auto& shapes = other.solution.modes.shapes;
  for (Eigen::Index i = 0; i < shapes.rows(); i += 3) {
    shapes.middleRows<3>(i) = (turn * shapes.middleRows<3>(i)).eval();
  }
  return other;
}

TEST(DiagnosisFaces, OfALeaningBodyAreSeenAcross) {
  const auto lying = plate().structure();
  const auto leans = leaning().structure();
  EXPECT_NEAR(leans.thickness, lying.thickness, 1e-9);
  EXPECT_EQ(leans.bending_power, 3.0);
  ASSERT_EQ(leans.cells.count(), lying.cells.count());
  const auto near = [](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double scale) {
    return (a - b).norm() < 1e-6 * (b.norm() + scale);
  };
  const double stiff = lying.directional.along_u.norm();
  EXPECT_TRUE(near(leans.directional.along_u, lying.directional.along_u, stiff));
  EXPECT_TRUE(near(leans.directional.along_v, lying.directional.along_v, stiff));
  EXPECT_TRUE(near(leans.directional.across, lying.directional.across, stiff));
  EXPECT_TRUE(near(leans.directional.shear, lying.directional.shear, stiff));
  const auto at = leans.surface.at({0.1, 0.05});
  const auto same = lying.surface.at({0.1, 0.05});
  ASSERT_TRUE(at && same);
  EXPECT_TRUE(near(at->shape, same->shape, 1.0));
  EXPECT_TRUE(near(at->slope_u, same->slope_u, 1.0));
  const auto middle = static_cast<std::size_t>(lying.cells.count() / 2);
  EXPECT_TRUE(near(leans.cells.shear[middle], lying.cells.shear[middle], stiff));
  EXPECT_TRUE(near(leans.cells.rotary[middle], lying.cells.rotary[middle], 1e-3));
  EXPECT_TRUE(near(leans.cells.stiffness[middle], lying.cells.stiffness[middle], stiff));
}

}  // namespace
}  // namespace chladni::stage
