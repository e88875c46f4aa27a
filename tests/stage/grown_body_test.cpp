// A body of another size, whose attached parts stay where they are in space: the hypothesis against
// the whole model of that size.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include "diagnosis/effect.h"
#include "diagnosis/fit/state.h"
#include "solved_text.h"
#include "stage/diagnosis_structure.h"

namespace chladni::stage {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

// A plate with a part on it. The mesh grows with it, so that both have the same elements.
struct CarryingPlate {
  std::string name;
  Eigen::Vector2d size;  // [mm]
  double edge;           // of the elements [mm]
  std::string attached;

  [[nodiscard]] std::string text(double longer) const {
    return fmt::format(R"(title = "plate"
geometry = {{ plate = {{ length = "{:.9g} mm", width = "{:.9g} mm", thickness = "4 mm" }} }}
material = {{ youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }}
mesh = {{ edge_length = "{:.9g} mm", order = 2 }}
modes = {{ count = 64, damping_ratio = 0.005 }}
{})",
                       size.x() * longer, size.y() * longer, edge * longer, attached);
  }
  [[nodiscard]] diagnosis::Structure structure(double longer) const {
    const auto solved = solved_with(text(longer));
    return structure_of(solved.study, solved.solution);
  }
};
void PrintTo(const CarryingPlate& plate, std::ostream* out) { *out << plate.name; }

std::string mass_at(double kg, double x_mm, double y_mm) {
  return fmt::format(
      "[[attachment]]\nname = \"motor\"\nkind = \"mass\"\nmass = \"{} kg\"\n"
      "at = [\"{} mm\", \"{} mm\"]\n",
      kg, x_mm, y_mm);
}
std::string spring_at(double stiffness, double x_mm, double y_mm) {
  return fmt::format(
      "[[attachment]]\nname = \"foot\"\nkind = \"spring\"\nstiffness = \"{} N/m\"\n"
      "direction = \"z\"\nat = [\"{} mm\", \"{} mm\"]\n",
      stiffness, x_mm, y_mm);
}

diagnosis::State grown(const diagnosis::Structure& structure, double longer) {
  auto state = diagnosis::state_of(structure);
  diagnosis::effect("size_error")
      .apply(state, structure, 0, VectorXd::Constant(1, std::log(longer)));
  return state;
}

double least(const MatrixXd& matrix) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(matrix).eigenvalues()(0);
}

// The first six frequencies of bending [Hz].
VectorXd first_hz(const diagnosis::State& state, Index rigid) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(state.stiffness, state.mass);
  return modes.eigenvalues().segment(rigid, 6).cwiseSqrt() / (2.0 * std::numbers::pi);
}

class GrownPlate : public testing::TestWithParam<CarryingPlate> {};

TEST_P(GrownPlate, AnswersAsTheWholeModelOfThatSize) {
  const auto drawn = GetParam().structure(1.0);
  auto taken_along = drawn;
  taken_along.grown = {};
  for (const double longer : {1.1, 1.15}) {
    const auto whole = GetParam().structure(longer);
    ASSERT_EQ(whole.rigid_count, drawn.rigid_count);
    const VectorXd expected = first_hz(diagnosis::state_of(whole), drawn.rigid_count);
    const auto worst = [&](const diagnosis::Structure& structure) {
      const auto state = grown(structure, longer);
      if (!(least(state.mass) > 0.0)) return HUGE_VAL;
      return (first_hz(state, drawn.rigid_count).array() / expected.array() - 1.0).abs().maxCoeff();
    };
    EXPECT_GT(worst(taken_along), 0.015) << longer;
    EXPECT_LT(worst(drawn), 0.06 * worst(taken_along)) << longer;
  }
}

// On the smaller body a part at the edge is beside it.
TEST_P(GrownPlate, HasAMassAndAStiffnessAtAnySize) {
  const auto drawn = GetParam().structure(1.0);
  for (const double longer : {0.7, 0.85, 0.9, 0.95, 1.05, 1.1, 1.15, 1.3}) {
    const auto state = grown(drawn, longer);
    EXPECT_GT(least(state.mass), 0.0) << longer;
    EXPECT_GT(least(state.stiffness), -1e-9 * state.stiffness.norm()) << longer;
  }
}

constexpr double kPlateMass = 0.6 * 0.4 * 0.004 * 2700.0;  // [kg]
constexpr double kStripMass = 1.0 * 0.06 * 0.004 * 2700.0;
INSTANTIATE_TEST_SUITE_P(
    Parts, GrownPlate,
    testing::Values(
        CarryingPlate{"mass_at_a_corner", {600, 400}, 70, mass_at(0.05 * kPlateMass, 300, 200)},
        CarryingPlate{"heavy_corner", {600, 400}, 70, mass_at(0.2 * kPlateMass, 300, 200)},
        CarryingPlate{"spring_at_a_corner", {600, 400}, 70, spring_at(2e4, 300, 200)},
        CarryingPlate{"mass_at_a_long_edge", {1000, 60}, 40, mass_at(0.05 * kStripMass, 400, 30)}),
    [](const auto& plate) { return plate.param.name; });

// The gain of Σ rowᵀ row, per growth, as the rows of sensors beneath a part change.
MatrixXd slope_of(const diagnosis::GrownForms& forms) {
  constexpr double kStep = 1e-5;
  return (forms.gain(kStep) - forms.gain(-kStep)) / (2.0 * kStep);
}

// It moves along the end face, and not off it.
TEST(GrownStrip, KeepsAPartOnItsEndFace) {
  std::string attached = R"([[attachment]]
name = "motor"
kind = "mass"
mass = "30 g"
at = ["500 mm", "10 mm", "-2 mm"]
)";
  for (const auto* axis : {"x", "y", "z"}) {
    attached += fmt::format(
        "[[sensor]]\nname = \"{0}\"\nat = [\"500 mm\", \"10 mm\", \"-2 mm\"]\n"
        "direction = \"{0}\"\n",
        axis);
  }
  const auto made = CarryingPlate{"strip", {1000, 60}, 25, attached}.structure(1.0);
  const auto& sensors = made.outputs;
  MatrixXd expected = MatrixXd::Zero(made.mode_count(), made.mode_count());
  for (Index i = 0; i < 3; ++i) {
    const RowVectorXd by = -sensors.places(i, 1) * sensors.slope_v.row(i);
    const MatrixXd half = 0.03 * sensors.shapes.row(i).transpose() * by;
    expected += half + half.transpose();
  }
  const MatrixXd found = slope_of(made.grown.masses);
  EXPECT_GT(expected.norm(), 0.0);
  EXPECT_LT((found - expected).norm(), 0.05 * expected.norm());
}

// Rotations that a lone spring leaves free stretch it where it is on the larger body.
TEST(GrownPlateOnASpring, IsStretchedByMotionsAtZeroHertz) {
  const auto made = CarryingPlate{"plate",
                                  {600, 400},
                                  70,
                                  spring_at(2e4, 300, 200) +
                                      "[[sensor]]\nname = \"s\"\nat = [\"300 mm\", \"200 mm\"]\n"
                                      "direction = \"z\"\n"}
                        .structure(1.0);
  ASSERT_EQ(made.rigid_count, 5);
  const RowVectorXd row = made.outputs.shapes.row(0);
  const RowVectorXd by = -0.3 * made.outputs.slope_u.row(0) - 0.2 * made.outputs.slope_v.row(0);
  const MatrixXd expected = 2e4 * by.head(5).transpose() * row.tail(20);
  const MatrixXd found = slope_of(made.grown.springs).topRows(5).rightCols(20);
  EXPECT_GT(expected.norm(), 0.0);
  EXPECT_LT((found - expected).norm(), 0.02 * expected.norm());
  EXPECT_LT(slope_of(made.grown.springs).topLeftCorner(5, 5).norm(), 1e-3 * expected.norm());
}

}  // namespace
}  // namespace chladni::stage
