// The simulation on its modes: sums over the body, derivatives along it, what is left out.
#include "stage/diagnosis_structure.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "diagnosed_plate.h"
#include "diagnosis/body_fields.h"
#include "diagnosis/effect.h"
#include "host/parallel.h"
#include "modal/frf.h"
#include "stage/at_channels.h"
#include "stage/reduction/upper_face.h"

namespace chladni::stage {
namespace {

const Solved& plate() {
  static const Solved solved = solved_with(kPlate + kChannels);
  return solved;
}

const diagnosis::Structure& structure() {
  static const auto made = stage::structure_of(plate().study, plate().solution);
  return made;
}

void expect_cells_to_sum_up(const diagnosis::Structure& of) {
  const Eigen::Index r = of.mode_count();
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(r, r);
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(r, r);
  for (std::size_t c = 0; c < of.cells.stiffness.size(); ++c) {
    stiffness += of.cells.stiffness[c];
    mass += of.cells.mass[c];
    EXPECT_EQ(of.cells.stiffness[c].topRows(of.rigid_count).norm(), 0.0) << c;
    EXPECT_EQ((of.cells.stiffness[c] - of.cells.stiffness[c].transpose()).norm(), 0.0) << c;
    EXPECT_EQ((of.cells.mass[c] - of.cells.mass[c].transpose()).norm(), 0.0) << c;
    EXPECT_GT(of.cells.mass[c].diagonal().minCoeff(), 0.0) << c;
  }
  const Eigen::MatrixXd fine =
      diagnosis::sum_of(of.fine.stiffness, Eigen::VectorXd::Ones(of.fine.count()));
  Eigen::MatrixXd both = Eigen::MatrixXd::Identity(fine.rows(), fine.cols());
  both.topLeftCorner(r, r) = squares(of).asDiagonal();
  EXPECT_LT((fine - both).norm(), 1e-8 * both.norm());
  const Eigen::MatrixXd whole = squares(of).asDiagonal();
  EXPECT_LT((stiffness - whole).cwiseAbs().maxCoeff(), 1e-8 * whole.maxCoeff());
  EXPECT_LT((mass - Eigen::MatrixXd::Identity(r, r)).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(DiagnosisStructure, CellsSumToTheWholeBody) {
  EXPECT_EQ(structure().cells.count(), 12 * 8);
  EXPECT_EQ(structure().fine.count(), 24 * 16);
  EXPECT_NEAR(structure().fine.pitch.maxCoeff(), 0.025, 1e-12);
  expect_cells_to_sum_up(structure());
  EXPECT_NEAR(structure().cells.area.sum(), 0.24, 1e-12);
  EXPECT_NEAR(structure().cells.area.maxCoeff(), 0.24 / 96.0, 1e-12);
  EXPECT_NEAR(structure().mass_kg, 0.6 * 0.4 * 0.01 * 2700.0, 1e-9);
  EXPECT_NEAR(structure().thickness, 0.01, 1e-12);
  EXPECT_EQ(structure().bending_power, 3.0);
}

// Sums over cells of one value each have the waves as their limit, about as the square of their
// size.
TEST(DiagnosisStructure, CellsConvergeToTheWaves) {
  const auto& of = structure();
  ASSERT_EQ(of.cells.waves.modulus.size(), 5U);
  constexpr Eigen::Index kLow = 16;  // modes that the cells resolve
  const auto coarse = diagnosis::smooth_fields(of.cells);
  const auto fine = diagnosis::smooth_fields(of.cells, of.fine.centres);
  for (std::size_t f = 0; f < 5; ++f) {
    const Eigen::MatrixXd wave = of.cells.waves.modulus[f].topLeftCorner(kLow, kLow);
    const auto off = [&](const std::vector<Eigen::MatrixXd>& cells, const Eigen::MatrixXd& fields) {
      const Eigen::VectorXd field = fields.col(static_cast<Eigen::Index>(f));
      return (diagnosis::sum_of(cells, field).topLeftCorner(kLow, kLow) - wave).norm();
    };
    EXPECT_LT(off(of.fine.stiffness, fine), 0.03 * wave.norm()) << f;
    EXPECT_LT(off(of.fine.stiffness, fine), 0.3 * off(of.cells.stiffness, coarse)) << f;
  }
}

TEST(DiagnosisStructure, LooksAtTheTopInTheBodysOwnCoordinates) {
  const auto& surface = structure().surface;
  EXPECT_EQ(surface.axis_u, Eigen::Vector3d::UnitX());
  EXPECT_EQ(surface.axis_v, Eigen::Vector3d::UnitY());
  EXPECT_EQ(surface.origin, Eigen::Vector3d::Zero());
  EXPECT_GE(surface.count(), 300);
  EXPECT_LE(surface.count(), 400);
  EXPECT_NEAR(surface.area.sum(), 0.24, 1e-12);
  EXPECT_LT(surface.places.colwise().mean().norm(), 1e-12);
  EXPECT_FALSE(surface.at({0.301, 0.0}).has_value());
  EXPECT_TRUE(surface.at({0.3, -0.2}).has_value());
  const auto here = surface.at({-0.131, 0.077});
  ASSERT_TRUE(here.has_value());
  EXPECT_LT((here->shape.transpose() - structure().outputs.shapes.row(0)).norm(), 1e-9);
  EXPECT_LT((structure().inputs.places.row(1) - Eigen::RowVector2d(0.3, 0.2)).norm(), 1e-12);
}

// The values where a channel stands 5 mm farther on.
Eigen::MatrixXd shapes_when_moved(double along_x, double along_y) {
  study::Study moved = plate().study;
  for (auto& sensor : moved.sensors) {
    sensor.at.point += Eigen::Vector3d(along_x, along_y, 0.0);
  }
  const auto places = stage::places_of(moved, plate().solution.model.body);
  return stage::shapes_at(moved.sensors, places.sensors, plate().solution.modes);
}

TEST(DiagnosisStructure, SlopesAreHowShapesChange) {
  constexpr double kMove = 5e-3;
  const auto& outputs = structure().outputs;
  const Eigen::MatrixXd along_u =
      (shapes_when_moved(0.0, 0.0) - shapes_when_moved(-kMove, 0.0)) / kMove;
  const Eigen::MatrixXd along_v =
      (shapes_when_moved(0.0, 0.0) - shapes_when_moved(0.0, -kMove)) / kMove;
  for (Eigen::Index j = 3; j < 16; ++j) {  // rotations and modes of long waves
    const double scale = outputs.slope_u.col(j).norm() + outputs.slope_v.col(j).norm();
    EXPECT_LT((outputs.slope_u - along_u).col(j).norm(), 0.05 * scale) << j;
    EXPECT_LT((outputs.slope_v - along_v).col(j).norm(), 0.05 * scale) << j;
    const auto here = structure().surface.at({-0.131, 0.077});
    EXPECT_NEAR(here->slope_u(j), outputs.slope_u(0, j), 1e-3 * scale) << j;
  }
}

TEST(DiagnosisStructure, SlopesOfAMirroredShapeVanishInTheMiddle) {
  const auto middle = structure().surface.at({0.0, 0.0});
  ASSERT_TRUE(middle.has_value());
  const double scale = structure().outputs.slope_u.col(7).norm();
  for (Eigen::Index j = 6; j < 14; ++j) {
    if (std::abs(middle->shape(j)) < 0.05) continue;  // even: then both slopes are 0
    EXPECT_LT(std::abs(middle->slope_u(j)), 1e-3 * scale) << j;
    EXPECT_LT(std::abs(middle->slope_v(j)), 1e-3 * scale) << j;
  }
}

TEST(DiagnosisStructure, ChannelsAsideMoveAlongTheChart) {
  study::Study turned = plate().study;
  turned.sensors[1].direction = Eigen::Vector3d::UnitX();
  const auto other = stage::structure_of(turned, plate().solution);
  EXPECT_EQ(other.outputs.shapes.row(1), structure().outputs.aside_u.row(1));
  EXPECT_EQ(other.outputs.aside_v.row(0), structure().outputs.aside_v.row(0));
  EXPECT_EQ(other.outputs.directions.row(1), Eigen::RowVector3d::UnitX());
  EXPECT_EQ(other.outputs.directions.row(0), Eigen::RowVector3d::UnitZ());
}

// A turn of what lies along x towards x would be a gain.
TEST(DiagnosisStructure, OnlyChannelsAlongTheNormalAreTilted) {
  study::Study turned = plate().study;
  turned.sensors[0].direction = Eigen::Vector3d(0.05, 0.0, -1.0).normalized();
  turned.sensors[1].direction = Eigen::Vector3d::UnitX();
  const auto other = stage::structure_of(turned, plate().solution);
  EXPECT_EQ(other.outputs.aside_u.row(0), structure().outputs.aside_u.row(0));
  EXPECT_EQ(other.outputs.aside_u.row(1).norm(), 0.0);
  EXPECT_EQ(other.outputs.aside_v.row(1).norm(), 0.0);
  const auto& tilt = diagnosis::effect("sensor_direction");
  auto state = diagnosis::state_of(other);
  tilt.apply(state, other, 1, Eigen::Vector2d(0.1, 0.1));
  EXPECT_EQ(state.outputs, other.outputs.shapes);
  tilt.apply(state, other, 0, Eigen::Vector2d(0.1, 0.1));
  EXPECT_GT((state.outputs - other.outputs.shapes).norm(), 0.0);
}

TEST(DiagnosisStructure, ModesLeftOutAreThereStatically) {
  const double f = 60.0;
  const auto few = stage::structure_of(plate().study, plate().solution, f);
  EXPECT_LT(few.mode_count(), structure().mode_count());
  EXPECT_GE(few.mode_count(), 18);
  const Eigen::MatrixXcd all = response(structure(), f);
  EXPECT_LT((response(few, f) - all).norm(), 2e-4 * all.norm());
  auto bare = few;
  bare.residual.setZero();
  EXPECT_GT((response(bare, f) - all).norm(), 2e-3 * all.norm());  // the test can fail
  EXPECT_LT((all - all.transpose()).norm(), 1e-9 * all.norm());    // pairs in one place
}

TEST(DiagnosisStructure, OneConstantOfTheMaterialGoesItsOwnWay) {
  const auto& d = structure().directional;
  const Eigen::VectorXd whole = squares(structure());
  const Eigen::VectorXd sum = (d.along_u + d.along_v + d.across + d.shear).diagonal();
  // The rest is shear across the thickness (and what the mesh locks): it grows with frequency.
  for (Eigen::Index j = 6; j < 16; ++j) {
    EXPECT_LT(sum(j), 1.001 * whole(j)) << j;
    EXPECT_GT(sum(j), (j < 12 ? 0.98 : 0.95) * whole(j)) << j;
  }

  // Young's modulus along x by 2 %: what the four constants of plane stress gain by it.
  const auto orthotropic = [](double e1) {
    return solved_with(
        fmt::format(
            "geometry = {{ plate = {{ length = \"600 mm\", width = \"400 mm\", thickness = \"10 "
            "mm\" "
            "}} }}\nmaterial = {{ symmetry = \"orthotropic\", youngs_modulus = [\"{} GPa\", \"40 "
            "GPa\", \"60 GPa\"], poissons_ratio = [0.3, 0.3, 0.3], shear_modulus = [\"25 GPa\", "
            "\"25 "
            "GPa\", \"20 GPa\"], density = \"2700 kg/m^3\" }}\nmesh = {{ edge_length = \"40 mm\", "
            "order = 2 }}\nmodes = {{ count = 24 }}\n",
            e1) +
        kChannels);
  };
  const auto before = orthotropic(70.0);
  const auto after = orthotropic(71.4);
  const auto found = stage::structure_of(before.study, before.solution).directional;
  const auto gain = [](double e1) {  // Q11, Q22, Q12 but for constant factors
    const double part = 1.0 / (1.0 - 0.09 * 40.0 / e1);
    return Eigen::Vector3d(e1 * part, part, part);
  };
  const Eigen::Vector3d relative = gain(71.4).cwiseQuotient(gain(70.0)).array() - 1.0;
  for (Eigen::Index j = 6; j < 14; ++j) {
    const double predicted = relative(0) * found.along_u(j, j) + relative(1) * found.along_v(j, j) +
                             relative(2) * found.across(j, j);
    const auto square = [&](const Solved& of) {
      return std::pow(2.0 * std::numbers::pi * of.solution.modes.frequency_hz(j), 2);
    };
    EXPECT_NEAR(predicted, square(after) - square(before), 4e-4 * square(before)) << j;
  }
}

// A plate of 18 mm that becomes 18.9 mm, its transverse shear and rotary inertia included: the
// modes predicted from those of the thinner one.
TEST(DiagnosisStructure, AThickerBodyIsPredictedFromItsParts) {
  const auto of = [](const char* thickness) {
    std::string text = kPlate + kChannels;
    text.replace(text.find("10 mm"), 5, thickness);
    return solved_with(text);
  };
  const auto thin = of("18 mm");
  const auto thick = of("18.9 mm");
  const auto made = stage::structure_of(thin.study, thin.solution);
  const auto gain = diagnosis::thickened(made, Eigen::VectorXd::Constant(made.cells.count(), 0.05));
  const Eigen::MatrixXd stiffness = Eigen::MatrixXd(squares(made).asDiagonal()) + gain.stiffness;
  const Eigen::MatrixXd mass =
      Eigen::MatrixXd::Identity(made.mode_count(), made.mode_count()) + gain.mass;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> predicted(stiffness, mass);
  for (Eigen::Index j = 6; j < 16; ++j) {
    const double hz = std::sqrt(predicted.eigenvalues()(j)) / (2.0 * std::numbers::pi);
    const double before = thin.solution.modes.frequency_hz(j);
    const double after = thick.solution.modes.frequency_hz(j);
    EXPECT_NEAR(hz - before, after - before, 0.01 * (after - before)) << j;
  }
}

TEST(DiagnosisStructure, TheSurfaceMayBeAskedFromSeveralThreads) {
  constexpr std::size_t kPlaces = 2000;
  const auto& surface = structure().surface;
  const auto place = [](std::size_t k) {
    return Eigen::Vector2d(0.3 * std::sin(0.7 * static_cast<double>(k)),
                           0.2 * std::cos(1.3 * static_cast<double>(k)));
  };
  std::vector<Eigen::VectorXd> together(kPlaces);
  parallel_ranges(kPlaces, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) together[k] = surface.at(place(k))->slope_u;
  });
  for (std::size_t k = 0; k < kPlaces; ++k) EXPECT_EQ(together[k], surface.at(place(k))->slope_u);
}

TEST(DiagnosisStructure, ABeamIsALine) {
  const auto beam = solved_with(
      R"(geometry = { beam = { length = "500 mm", width = "20 mm", thickness = "2 mm" } }
material = { youngs_modulus = "210 GPa", poissons_ratio = 0.3, density = "7800 kg/m^3" }
mesh = { edge_length = "20 mm", order = 2 }
modes = { count = 16 }
[[sensor]]
name = "s"
at = ["-200 mm", "0 mm"]
direction = "z"
[[actuator]]
name = "a"
at = ["200 mm", "0 mm"]
direction = "z"
)");
  const auto made = stage::structure_of(beam.study, beam.solution);
  EXPECT_EQ(made.surface.count(), 100);
  EXPECT_EQ(made.surface.places.col(1).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_EQ(made.cells.count(), 24);
  EXPECT_TRUE(made.surface.at({0.1, 0.009}).has_value());
  EXPECT_EQ(made.bending_power, 3.0);
  expect_cells_to_sum_up(made);
}

TEST(DiagnosisStructure, APocketedTableHasItsFaceSheetOnTop) {
  const auto table = solved_with(R"(
[geometry.wafer_table]
length = "300 mm"
width = "300 mm"
height = "40 mm"
pockets = [3, 3]
face_sheet = "6 mm"
rib = "6 mm"
corner_cutout = "30 mm"
[material]
youngs_modulus = "70 GPa"
poissons_ratio = 0.33
density = "2700 kg/m^3"
[mesh]
edge_length = "30 mm"
order = 2
[modes]
count = 12
[[sensor]]
name = "s"
at = ["100 mm", "100 mm"]
direction = "z"
[[actuator]]
name = "a"
at = ["-100 mm", "100 mm"]
direction = "z"
)");
  const auto made = stage::structure_of(table.study, table.solution);
  EXPECT_FALSE(made.surface.at({0.14, 0.14}).has_value());
  EXPECT_NEAR(made.surface.area.sum(), 0.09 - 4 * 0.0009, 0.03 * 0.09);
  EXPECT_EQ(made.bending_power, 0.0);  // 40 of 300 mm: it shears
  expect_cells_to_sum_up(made);
}

}  // namespace
}  // namespace chladni::stage
