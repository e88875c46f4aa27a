// Complex shapes on one scale, and responses at places that no sensor measures.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "gain_case.h"
#include "identification/damping_coupling.h"
#include "identification/spatio_temporal.h"
#include "modal/state_space.h"
#include "tests/identification/general_case.h"

namespace chladni::identification {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

simulators::FrfCase with_dashpot(double constant = 1.0) {
  auto faults = quiet();
  faults.dashpot = constant;
  return simulators::beam5x5(faults);
}

// The complex modes of the truth as a fit that knows them to 1e-6 of their size; each turned by
// `phase` times its number.
ModalFit general_fit(const simulators::FrfCase& made, double phase = 0.0) {
  const auto truth = general_truth(made);
  ModalFit fit;
  fit.model = made.truth;
  const Eigen::ArrayXd own = truth.pole.cwiseAbs();
  fit.model.frequency_hz = own / (2.0 * std::numbers::pi);
  fit.model.damping_ratio = -truth.pole.real().array() / own;
  fit.model.dampers = {};
  ComplexShapes shapes;
  shapes.outputs = truth.outputs;
  shapes.inputs = truth.inputs;
  for (Index m = 0; m < truth.pole.size(); ++m) {
    const auto turn = std::polar(1.0, phase * static_cast<double>(m + 1));
    shapes.outputs.col(m) *= turn;
    shapes.inputs.row(m) /= turn;
  }
  const auto spread = [](const Eigen::MatrixXcd& side) {
    return MatrixXd::Constant(side.rows(), side.cols(), 1e-6 * side.cwiseAbs().maxCoeff());
  };
  shapes.output_real_std = shapes.output_imaginary_std = spread(shapes.outputs);
  shapes.input_real_std = shapes.input_imaginary_std = spread(shapes.inputs);
  fit.model.output_shapes = shapes.outputs.real();
  fit.model.input_shapes = shapes.inputs.real();
  const auto entries = 2 + fit.model.output_count() + fit.model.input_count();
  for (Index m = 0; m < truth.pole.size(); ++m) {
    const double known = 1e-6 * shapes.outputs.col(m).cwiseAbs().maxCoeff();
    fit.mode_covariance.emplace_back(known * known * MatrixXd::Identity(entries, entries));
  }
  fit.complex = std::move(shapes);
  return fit;
}

struct Matched {
  simulators::FrfCase made;
  ModalFit fit;
  GainMatch match;
};

Matched with(simulators::FrfCase made, double phase = 0.0) {
  auto fit = general_fit(made, phase);
  auto match = matched(made, fit, with_pairs(made));
  return {std::move(made), std::move(fit), std::move(match)};
}

PlacesOfInterest rows_of(const Matched& one, const std::vector<Index>& rows) {
  const auto q = one.fit.model.input_count();
  return {one.match.shapes(rows, Eigen::all), one.match.deviation(rows, Eigen::all),
          MatrixXd::Zero(std::ssize(rows), q), one.match.imaginary(rows, Eigen::all),
          one.match.imaginary_deviation(rows, Eigen::all)};
}

TEST(ComplexMatch, GivesTheSensorsOwnResponsesBack) {
  const auto one = with(with_dashpot());
  auto interest = rows_of(one, {0, 1, 2, 3, 4});
  interest.residual = one.made.truth.residual;
  const auto& lines = one.made.measured.frequency_hz;
  const auto found = predicted(one.fit, one.match, interest, lines);
  const auto space =
      state_space(model_at(one.fit, one.match, interest), complex_shapes_at(one.match, interest));
  for (std::size_t k = 0; k < found.value.size(); k += 7) {
    const double size = one.made.exact[k].norm();
    EXPECT_LT((found.value[k] - one.made.exact[k]).norm(), 1e-6 * size) << k;
    const auto same = modal::response(space, lines(static_cast<Index>(k)));
    EXPECT_LT((found.value[k] - same).norm(), 1e-10 * size) << k;
  }
}

// Sensors 2 and 5, actuators 1 to 4, the pair at 2: what actuators 1, 3 and 4 say of sensors there.
TEST(ComplexMatch, PredictsTheSensorsThatAreNotThere) {
  const auto whole = with_dashpot();
  for (const double phase : {0.0, 0.01}) {
    const auto one = with(simulators::part(whole, {1, 4}, {0, 1, 2, 3}), phase);
    ASSERT_EQ(one.match.rows.size(), 5U);
    auto interest = rows_of(one, {2, 3, 4});
    const std::vector<Index> places{0, 2, 3};
    interest.residual = whole.truth.residual(places, std::vector<Index>{0, 1, 2, 3});
    const auto found =
        predicted(one.fit, one.match, interest, one.made.measured.frequency_hz).value;
    auto real = one.fit;
    real.complex.reset();
    auto of_real = interest;
    of_real.imaginary.resize(0, 0);
    of_real.imaginary_deviation.resize(0, 0);
    const auto without = predicted(real, one.match, of_real, one.made.measured.frequency_hz).value;
    double off = 0.0;
    double off_without = 0.0;
    double size = 0.0;
    for (std::size_t k = 0; k < found.size(); ++k) {
      const Eigen::MatrixXcd there = whole.exact[k](places, std::vector<Index>{0, 1, 2, 3});
      off += (found[k] - there).squaredNorm();
      off_without += (without[k] - there).squaredNorm();
      size += there.squaredNorm();
    }
    EXPECT_LT(std::sqrt(off / size), 1e-3) << phase;
    EXPECT_GT(std::sqrt(off_without / size), 2e-2) << phase;
  }
}

TEST(ComplexMatch, TakesPairsOfOppositeDirectionsAsStated) {
  auto made = with_dashpot();
  const auto one = with(made);
  auto fit = one.fit;
  fit.model.input_shapes *= -1.0;
  fit.complex->inputs *= -1.0;
  for (auto& input : made.measured.inputs) input.direction *= -1.0;
  const auto match = matched(made, fit, with_pairs(made));
  EXPECT_EQ(match.warnings, one.match.warnings);
  const double size = one.match.imaginary.norm();
  EXPECT_LT((match.imaginary - one.match.imaginary).norm(), 1e-9 * size);
  EXPECT_LT((match.input_imaginary + one.match.input_imaginary).norm(), 1e-9 * size);
}

TEST(ComplexMatch, FindsTheRowOfAFurtherSensor) {
  const auto one = with(with_dashpot());
  auto record = modal::part(one.made.measured, {3}, {0, 1, 2, 3, 4});
  const auto row = fitted_row(one.fit, one.match, fit_data(record));
  EXPECT_LT((row.shape - one.match.shapes.row(3)).norm(), 1e-4 * row.shape.norm());
}

// The structure's own undamped modes, seen without place 3.
TEST(DampingCoupling, TellsImaginaryPartsWhereNoSensorIs) {
  const auto made = with_dashpot(0.1);
  const auto whole = with(made);
  const std::vector<Index> seen{0, 1, 3, 4};
  const auto one = with(simulators::part(made, seen, seen));
  const MatrixXd shapes = whole.made.truth.output_shapes;
  const CouplingBasis basis{whole.made.truth.frequency_hz, shapes(seen, Eigen::all), shapes.row(2)};
  const auto parts = imaginary_parts(one.fit, one.match, basis);
  Eigen::RowVectorXd there = whole.match.imaginary.row(2);
  for (Index m = 0; m < there.size(); ++m) {  // the sign of a mode is free
    if (whole.match.shapes.col(m)(seen).dot(one.match.shapes.col(m)) < 0.0) there(m) *= -1.0;
  }
  const Eigen::RowVectorXd off = parts.mean.row(0) - there;
  EXPECT_LT(off.norm(), 0.25 * there.norm());
  EXPECT_LT((off.array() / parts.deviation.row(0).array()).abs().maxCoeff(), 3.0);
}

TEST(DampingCoupling, RefusesRealShapes) {
  auto one = with(with_dashpot());
  one.fit.complex.reset();
  const MatrixXd shapes = one.made.truth.output_shapes;
  EXPECT_THROW(
      (void)imaginary_parts(one.fit, one.match, {one.made.truth.frequency_hz, shapes, shapes}),
      InvalidInput);
}

}  // namespace
}  // namespace chladni::identification
