// In which direction channels count, and what that means for the errors of modes.
#include <gtest/gtest.h>

#include <cmath>

#include "diagnosis/loaded_plate.h"
#include "diagnosis/modes/modes_fit.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Sensor i along the other direction, in the structure and in the data.
void turn_sensor(Index i, Structure& structure, MeasuredModes& measured) {
  auto& side = structure.outputs;
  for (auto* rows : {&side.shapes, &side.slope_u, &side.slope_v, &side.aside_u, &side.aside_v}) {
    if (rows->rows() > 0) rows->row(i) *= -1.0;
  }
  if (side.upper.rows() > 0) side.upper.row(i) *= -1.0;
  structure.residual.row(i) *= -1.0;
  if (side.directions.rows() == 0) {
    side.directions = Eigen::RowVector3d::UnitZ().replicate(side.count(), 1);
  }
  side.directions.row(i) *= -1.0;
  measured.output_shapes.row(i) *= -1.0;
}

// In which direction a sensor counts is a choice, and changes nothing.
TEST(Errors, DoNotDependOnTheDirectionInWhichAChannelCounts) {
  Structure plate = small_plate();
  MeasuredModes measured = measured_of(modes_of(loaded()), 0.05);
  const double evidence = ModesProblem(plate, measured, Tolerances{}, true).nothing().log_evidence;
  for (const Index i : {1, 3}) turn_sensor(i, plate, measured);
  EXPECT_NEAR(ModesProblem(plate, measured, Tolerances{}, true).nothing().log_evidence, evidence,
              1e-6 * std::abs(evidence));
}

// Each component of a displacement has a smooth error of its own.
TEST(Errors, ThatAreSmoothDoNotLinkDirectionsAcrossEachOther) {
  Structure plate = small_plate();
  const Index n = plate.output_count();
  const auto covariance = [&] {
    const MatrixXd factor = smooth_factor(plate);
    return MatrixXd((factor * factor.transpose()).topLeftCorner(n, n));
  };
  const MatrixXd upright = covariance();
  plate.outputs.directions = Eigen::RowVector3d::UnitZ().replicate(n, 1);
  EXPECT_LT((covariance() - upright).cwiseAbs().maxCoeff(), 1e-12);
  plate.outputs.directions.row(2) = Eigen::RowVector3d::UnitX();
  MatrixXd expected = upright;
  expected.row(2).setZero();
  expected.col(2).setZero();
  expected(2, 2) = upright(2, 2);
  EXPECT_LT((covariance() - expected).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace chladni::diagnosis
