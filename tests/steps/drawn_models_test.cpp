// Models drawn for the loop of an observer scatter as the fit says that it is uncertain.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include "steps/observer/drawn.h"

namespace chladni::steps {
namespace {

using Eigen::Index;

constexpr Index kOutputs = 3, kInputs = 2, kRigid = 2, kModes = 4;

Eigen::MatrixXd covariance(const Eigen::VectorXd& deviation, Draw& draw) {
  Eigen::MatrixXd factor(deviation.size(), deviation.size());
  for (double& entry : factor.reshaped()) entry = draw.normal();
  factor.rowwise().normalize();
  factor = deviation.asDiagonal() * factor;
  return factor * factor.transpose();
}

// Two modes at 0 Hz and two above it.
IdentifiedModel uncertain() {
  Draw draw(3);
  IdentifiedModel result;
  auto& fit = result.found.fit;
  auto& model = fit.model;
  model.rigid_count = kRigid;
  model.frequency_hz = Eigen::Vector4d(0.0, 0.0, 40.0, 130.0);
  model.damping_ratio = Eigen::Vector4d(0.0, 0.0, 0.01, 0.02);
  model.output_shapes.resize(kOutputs, kModes);
  model.input_shapes.resize(kModes, kInputs);
  for (double& entry : model.output_shapes.reshaped()) entry = draw.normal();
  for (double& entry : model.input_shapes.reshaped()) entry = draw.normal();
  const Index both = kOutputs + kInputs;
  for (Index m = 0; m < kModes; ++m) {
    Eigen::VectorXd deviation = Eigen::VectorXd::Constant(2 + both, 1e-3);
    deviation(0) = 1e-3 * 2.0 * std::numbers::pi * model.frequency_hz(m);
    deviation(1) = 1e-2 * model.damping_ratio(m);
    fit.mode_covariance.push_back(covariance(deviation, draw));
  }
  fit.rigid_covariance = covariance(Eigen::VectorXd::Constant(kRigid * both, 2e-3), draw);
  return result;
}

// ω, ζ, L and R of a mode above 0 Hz, or all factors of the modes at 0 Hz.
Eigen::VectorXd numbers_of(const modal::ReducedModel& model, Index m) {
  Eigen::VectorXd all(2 + kOutputs + kInputs);
  all << 2.0 * std::numbers::pi * model.frequency_hz(m), model.damping_ratio(m),
      model.output_shapes.col(m), model.input_shapes.row(m).transpose();
  return all;
}

Eigen::VectorXd rigid_numbers_of(const modal::ReducedModel& model) {
  Eigen::VectorXd all(kRigid * (kOutputs + kInputs));
  all << model.output_shapes.leftCols(kRigid).reshaped(),
      model.input_shapes.topRows(kRigid).reshaped();
  return all;
}

TEST(DrawnModels, ScatterByTheCovarianceOfTheFit) {
  const auto identified = uncertain();
  const auto& fit = identified.found.fit;
  Draw draw(1);
  constexpr int kDraws = 3000;
  Eigen::MatrixXd rigid = Eigen::MatrixXd::Zero(10, 10);
  std::vector<Eigen::MatrixXd> flexible(2, Eigen::MatrixXd::Zero(7, 7));
  for (int k = 0; k < kDraws; ++k) {
    const auto other = drawn_fit(identified, draw).model;
    const Eigen::VectorXd off = rigid_numbers_of(other) - rigid_numbers_of(fit.model);
    rigid += off * off.transpose() / kDraws;
    for (Index m = kRigid; m < kModes; ++m) {
      const Eigen::VectorXd own = numbers_of(other, m) - numbers_of(fit.model, m);
      flexible[static_cast<std::size_t>(m - kRigid)] += own * own.transpose() / kDraws;
    }
  }
  const auto expect_alike = [](const Eigen::MatrixXd& found, const Eigen::MatrixXd& told) {
    const Eigen::VectorXd unit = told.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd off = unit.asDiagonal() * (found - told) * unit.asDiagonal();
    EXPECT_LT(off.cwiseAbs().maxCoeff(), 6.0 * std::sqrt(2.0 / kDraws)) << off;
  };
  expect_alike(rigid, fit.rigid_covariance);
  expect_alike(flexible[0], fit.mode_covariance[2]);
  expect_alike(flexible[1], fit.mode_covariance[3]);
}

// Shapes at points scatter by their own deviations. What is wrong of the scale of all shapes is
// wrong of theirs too, but never beyond the deviation that is theirs.
TEST(DrawnModels, HaveShapesAtPointsWithTheScaleOfTheFit) {
  auto identified = uncertain();
  const auto& fit = identified.found.fit;
  identified.match.shapes = fit.model.output_shapes;
  const auto shapes = std::make_shared<Interpolated>();
  shapes->measured.identified = std::make_shared<const IdentifiedModel>(identified);
  Observer observer;
  observer.shapes = shapes;
  auto& points = observer.places.at_points;
  points.shapes = Eigen::MatrixXd::Constant(2, kModes, 0.5);
  points.deviation = Eigen::MatrixXd(2, kModes);
  points.deviation << 0.1, 0.1, 0.1, 0.1, 1e-5, 1e-5, 1e-5, 1e-5;
  const Index m = kRigid;
  const Eigen::VectorXd own = fit.model.output_shapes.col(m);
  const Eigen::MatrixXd covariance = fit.mode_covariance[2].block(2, 2, kOutputs, kOutputs);
  const double scale = std::sqrt(own.dot(covariance * own)) / own.squaredNorm();
  Draw draw(2);
  constexpr int kDraws = 3000;
  Eigen::Vector2d square(0.0, 0.0), with_scale(0.0, 0.0);
  for (int k = 0; k < kDraws; ++k) {
    const auto other = drawn_fit(identified, draw);
    const auto places = drawn_places(observer.places, observer, other, draw);
    const Eigen::Vector2d off = places.at_points.shapes.col(m) - points.shapes.col(m);
    const double change = own.dot(other.model.output_shapes.col(m) - own) / own.squaredNorm();
    square += off.cwiseAbs2() / kDraws;
    with_scale += change * off / kDraws;
  }
  for (const Index i : {0, 1}) {
    const double deviation = points.deviation(i, m);
    EXPECT_NEAR(std::sqrt(square(i)) / deviation, 1.0, 0.05) << i;
    const double told = std::min(0.5 * scale, deviation) * scale;
    EXPECT_NEAR(with_scale(i), told, 6.0 * scale * deviation / std::sqrt(kDraws)) << i;
  }
  EXPECT_GT(0.5 * scale, points.deviation(1, m));
}

TEST(DrawnModels, CountWhatIsNotKnownOfModesAtZeroToo) {
  auto identified = uncertain();
  const Eigen::MatrixXd points = Eigen::MatrixXd::Constant(1, kModes, 0.1);
  EXPECT_EQ(unknown_numbers(identified, points), 0);
  identified.found.fit.rigid_covariance(4, 4) = std::numeric_limits<double>::infinity();
  identified.found.fit.mode_covariance[3](2, 2) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(unknown_numbers(identified, points), 2);
}

}  // namespace
}  // namespace chladni::steps
