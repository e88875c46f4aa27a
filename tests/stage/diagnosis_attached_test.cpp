// The simulation on its modes where dashpots, resonators, springs and masses hang on the body.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "diagnosed_plate.h"
#include "diagnosis/body_fields.h"

namespace chladni::stage {
namespace {

TEST(DiagnosisStructure, DashpotsAndResonatorsAreInIt) {
  const auto hung = solved_with(kPlate + kChannels + R"(
[[attachment]]
name = "dashpot"
kind = "damper"
at = ["300 mm", "200 mm"]
direction = "z"
damping = "3 N s/m"
[[attachment]]
name = "bracket"
kind = "resonator"
at = ["-300 mm", "200 mm"]
direction = "z"
mass = "100 g"
frequency = "70 Hz"
)");
  const auto made = stage::structure_of(hung.study, hung.solution);
  const Eigen::RowVectorXd corner = made.outputs.shapes.row(1);
  EXPECT_LT((made.dashpots - 3.0 * corner.transpose() * corner).norm(),
            1e-9 * made.dashpots.norm());
  const Eigen::MatrixXcd all = response(made, 40.0);
  const Eigen::MatrixXcd few = response(stage::structure_of(hung.study, hung.solution, 40.0), 40.0);
  EXPECT_GT(made.residual.norm(), 0.0);
  EXPECT_LT((few - all).norm(), 2e-4 * all.norm());
}

// Cells are of the body alone; what the modes hold beyond them is what the study attaches.
TEST(DiagnosisStructure, KnowsWhatOfItsModesIsAttached) {
  const auto held = solved_with(kPlate + kChannels + R"(
[[attachment]]
name = "flexure"
kind = "spring"
at = ["300 mm", "200 mm"]
direction = "z"
stiffness = "20 kN/m"
[[attachment]]
name = "coil"
kind = "mass"
at = ["-131 mm", "77 mm"]
mass = "300 g"
)");
  const auto made = stage::structure_of(held.study, held.solution);
  const Eigen::Index r = made.mode_count();
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(made.cells.count());
  const Eigen::MatrixXd stiffness = diagnosis::sum_of(made.cells.stiffness, ones);
  const Eigen::MatrixXd mass = diagnosis::sum_of(made.cells.mass, ones);
  const Eigen::MatrixXd whole = squares(made).asDiagonal();
  EXPECT_LT((stiffness + made.springs - whole).norm(), 1e-8 * whole.norm());
  EXPECT_LT((mass + made.masses - Eigen::MatrixXd::Identity(r, r)).norm(), 1e-8);
  const Eigen::RowVectorXd foot = made.outputs.shapes.row(1);
  const Eigen::MatrixXd spring = 2e4 * foot.transpose() * foot;
  EXPECT_LT((made.springs - spring).norm(), 1e-4 * spring.norm());
  const Eigen::RowVectorXd along = made.outputs.shapes.row(0);
  const Eigen::MatrixXd coil =
      0.3 * (along.transpose() * along +
             made.outputs.aside_u.row(0).transpose() * made.outputs.aside_u.row(0) +
             made.outputs.aside_v.row(0).transpose() * made.outputs.aside_v.row(0));
  EXPECT_LT((made.masses - coil).norm(), 1e-6 * coil.norm());
  const auto bare = solved_with(kPlate + kChannels);
  EXPECT_EQ(stage::structure_of(bare.study, bare.solution).springs.size(),
            0);  // nothing is attached
  EXPECT_EQ(made.frequency_error, held.solution.frequency_error.head(r));
}

// How the row of a sensor changes as the body grows beneath it about its origin.
Eigen::RowVectorXd moved(const diagnosis::ChannelSide& side, Eigen::Index i) {
  return -side.places(i, 0) * side.slope_u.row(i) - side.places(i, 1) * side.slope_v.row(i);
}

// The change of rowᵀ row as the row changes.
Eigen::MatrixXd change_of_square(const Eigen::RowVectorXd& row, const Eigen::RowVectorXd& by) {
  const Eigen::MatrixXd half = row.transpose() * by;
  return half + half.transpose();
}

// The change of the matrix per growth of the body.
Eigen::MatrixXd per_growth(const diagnosis::GrownForms& forms) {
  constexpr double kGrowth = 1e-5;
  return (forms.gain(kGrowth) - forms.gain(-kGrowth)) / (2.0 * kGrowth);
}

// They stay where they are in space. The second place is a corner, where a smaller body ends: there
// both are differences to one side.
TEST(DiagnosisStructure, KnowsWhatIsAttachedToALargerBody) {
  const auto held = solved_with(kPlate + kChannels + R"(
[[attachment]]
name = "bracket"
kind = "resonator"
at = ["-131 mm", "77 mm"]
direction = "z"
mass = "100 g"
frequency = "70 Hz"
[[attachment]]
name = "flexure"
kind = "spring"
at = ["300 mm", "200 mm"]
direction = "z"
stiffness = "20 kN/m"
[[attachment]]
name = "dashpot"
kind = "damper"
at = ["300 mm", "200 mm"]
direction = "z"
damping = "3 N s/m"
[[attachment]]
name = "second_bracket"
kind = "resonator"
at = ["300 mm", "200 mm"]
direction = "z"
mass = "50 g"
frequency = "30 Hz"
)");
  const auto made = stage::structure_of(held.study, held.solution);
  const auto& sensors = made.outputs;
  const Eigen::Index r = made.mode_count();
  const Eigen::MatrixXd own = held.solution.extra_shapes.leftCols(r);
  const Eigen::MatrixXd foot = change_of_square(sensors.shapes.row(1), moved(sensors, 1));
  const Eigen::MatrixXd dashpots = per_growth(made.grown.dashpots);
  EXPECT_LT((dashpots - 3.0 * foot).norm(), 0.02 * dashpots.norm());
  const auto of_bracket = [&](Eigen::Index i, double mass, double hz) -> Eigen::MatrixXd {
    return mass * std::pow(2.0 * std::numbers::pi * hz, 2) *
           change_of_square(own.row(i) - sensors.shapes.row(i), -moved(sensors, i));
  };
  const Eigen::MatrixXd springs = 2e4 * foot + of_bracket(0, 0.1, 70.0) + of_bracket(1, 0.05, 30.0);
  const Eigen::MatrixXd found = per_growth(made.grown.springs);
  EXPECT_LT((found - springs).norm(), 0.02 * springs.norm());
  const Eigen::Index rigid = made.rigid_count;
  const Eigen::MatrixXd of_rigid = springs.topRightCorner(rigid, r - rigid);
  EXPECT_GT(of_rigid.norm(), 0.0);  // the place leaves the axes of the rotations
  EXPECT_LT((found.topRightCorner(rigid, r - rigid) - of_rigid).norm(), 0.02 * of_rigid.norm());
  // The brackets follow the body across z.
  EXPECT_GT(per_growth(made.grown.masses).norm(), 0.0);
  const auto bare = solved_with(kPlate + kChannels);
  const auto free = stage::structure_of(bare.study, bare.solution).grown;
  EXPECT_EQ(free.springs.count() + free.masses.count() + free.dashpots.count(), 0);
}

}  // namespace
}  // namespace chladni::stage
