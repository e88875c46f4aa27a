#include "diagnosis/fit.h"

#include <gtest/gtest.h>

#include "diagnosis/small_plate.h"

namespace chladni::diagnosis {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Beside the rim nothing hangs on the plate: a difference across it is no slope.
TEST(Sensitivities, AreOneSidedOnTheRim) {
  const auto& plate = small_plate();
  Observed observed;
  observed.outputs = plate.output_count();
  observed.inputs = plate.input_count();
  observed.omega = some_lines();
  observed.value = responses(state_of(plate), observed.omega);
  observed.weight = observed.value.cwiseAbs().cwiseInverse();
  const std::vector<Deviation> none;
  const Problem problem{plate, observed, none};
  const auto slopes = [&](double u) {
    const std::vector<Supposed> causes{{&effect("point_mass"), 0, Eigen::Vector3d(0.05, u, 0.07)}};
    const State state = state_of(problem, causes, VectorXd(0));
    return sensitivities(problem, causes, VectorXd(0), solved(state, Body(state, observed.omega)));
  };
  for (const double side : {-1.0, 1.0}) {
    const MatrixXd on = slopes(side * 0.3);
    const MatrixXd off = slopes(side * (0.3 - 1e-3));
    for (const int column : {0, 1, 2}) {
      EXPECT_LT((on - off).col(column).norm(), 0.05 * off.col(column).norm()) << column;
    }
  }
}

}  // namespace
}  // namespace chladni::diagnosis
