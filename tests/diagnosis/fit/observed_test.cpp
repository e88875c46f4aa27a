// Measured data in the form that a diagnosis uses.
#include "diagnosis/observed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <utility>

#include "base/draw.h"
#include "diagnosis/fit/responses.h"
#include "diagnosis/small_plate.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;

constexpr double kNoiseOfOne = 0.01;
constexpr Index kManyLines = 400;

// The plate's own responses, means of `records` with sample variances of as many less one.
modal::FrfSet averaged(int records, unsigned seed) {
  const auto& plate = small_plate();
  modal::FrfSet set;
  for (const auto& name : plate.outputs.names) set.outputs.emplace_back().name = name;
  for (const auto& name : plate.inputs.names) set.inputs.emplace_back().name = name;
  set.frequency_hz = Eigen::VectorXd::LinSpaced(kManyLines, 31.0, 893.0);
  const auto exact = responses(state_of(plate), 2.0 * 3.14159265358979 * set.frequency_hz);
  Draw draw(seed);
  for (Index k = 0; k < kManyLines; ++k) {
    Eigen::MatrixXcd value(plate.output_count(), plate.input_count());
    Eigen::MatrixXd variance(value.rows(), value.cols());
    for (Index e = 0; e < value.size(); ++e) {
      Eigen::VectorXcd sample(records);
      for (auto& one : sample) {
        const double real = draw.normal();
        one = exact(k, e) + kNoiseOfOne * std::complex<double>(real, draw.normal());
      }
      value(e) = sample.mean();
      variance(e) = (sample.array() - sample.mean()).abs2().sum() / (records - 1.0) / records;
    }
    set.value.push_back(value);
    set.variance.push_back(variance);
  }
  set.averages = records - 1.0;
  return set;
}

double misfit_per_number(const modal::FrfSet& set) {
  const auto one = seen(small_plate(), set, HUGE_VAL);
  const auto model = responses(state_of(one.structure), one.observed.omega);
  return residual(one.observed, model).squaredNorm() / one.observed.number_count();
}

// A variance of few samples is often too small: the misfit of the truth would look like a misfit of
// the model.
TEST(Observed, TakesTheMisfitOfTheTruthForNoiseWhereVariancesAreOfFewSamples) {
  auto set = averaged(8, 5);
  // The mean of F(2, 14) is 7/6; of N numbers it is known to some 2 %.
  EXPECT_NEAR(misfit_per_number(set), 1.0, 0.05);
  set.averages = 0.0;
  EXPECT_NEAR(misfit_per_number(set), 7.0 / 6.0, 0.05);
}

// Responses that are a level of the sensor times a level of the actuator have that level, whatever
// else was measured; of complete data it is row times column over all.
TEST(ModelVariance, IsThatOfTheLevelsOfTheChannelsWhateverIsMissing) {
  Observed observed;
  observed.outputs = 3;
  observed.inputs = 4;
  observed.omega = Eigen::Vector2d(10.0, 20.0);
  const Eigen::Vector3d sensors(1.0, 0.3, 2.0);
  const Eigen::Vector4d actuators(0.5, 5.0, 3.0, 1.0);
  const Eigen::MatrixXd level = sensors * actuators.transpose();
  observed.value.resize(2, 12);
  observed.value.row(0) = level.cast<std::complex<double>>().reshaped().transpose();
  observed.value.row(1) = 7.0 * observed.value.row(0);
  observed.weight.setOnes(2, 12);
  for (const auto& [i, j] : {std::pair<Index, Index>{0, 1}, {1, 0}, {1, 3}, {2, 2}}) {
    observed.weight(0, i + 3 * j) = 0.0;
    observed.value(0, i + 3 * j) = 0.0;
  }
  const Eigen::MatrixXd found = model_variance(observed, 0.01);
  for (Index c = 0; c < 12; ++c) {
    const double power = 1e-4 * std::pow(level.reshaped()(c), 2);
    if (observed.weight(0, c) > 0.0) {
      EXPECT_NEAR(found(0, c), power, 1e-3 * power) << c;
    }
    EXPECT_NEAR(found(1, c), 49.0 * power, 1e-9 * power) << c;
  }
}

// Two responses of each channel were measured, and the levels are 40 : 1. They follow from the
// measured ones alone, however many rounds that takes.
TEST(ModelVariance, IsThatOfTheLevelsAlsoWhereTheseAreFarApart) {
  Observed observed;
  observed.outputs = observed.inputs = 3;
  observed.omega = Eigen::VectorXd::Constant(1, 10.0);
  const Eigen::Vector3d levels(1.0, std::sqrt(40.0), 40.0);
  const Eigen::MatrixXd level = levels * levels.transpose();
  observed.value = level.cast<std::complex<double>>().reshaped().transpose();
  observed.weight.setOnes(1, 9);
  for (const Index c : {0, 5, 7}) observed.weight(0, c) = 0.0;
  const Eigen::MatrixXd found = model_variance(observed, 0.01);
  for (Index c = 0; c < 9; ++c) {
    const double power = 1e-4 * std::pow(level.reshaped()(c), 2);
    if (observed.weight(0, c) > 0.0) {
      EXPECT_NEAR(found(0, c), power, 1e-3 * power) << c;
    }
  }
}

TEST(ModelVariance, IsOfTheMeansOfCompleteData) {
  Observed observed;
  observed.outputs = observed.inputs = 2;
  observed.omega = Eigen::VectorXd::Constant(1, 10.0);
  observed.value.resize(1, 4);
  observed.value << 1.0, 2.0, 3.0, 0.5;  // columns (1, 2) and (3, 1/2)
  observed.weight.setOnes(1, 4);
  const double mean = (1.0 + 4.0 + 9.0 + 0.25) / 4.0;
  const auto found = model_variance(observed, 0.1);
  EXPECT_NEAR(found(0), 0.01 * 5.0 * 2.5 / mean, 1e-12);
  EXPECT_NEAR(found(3), 0.01 * 2.125 * 4.625 / mean, 1e-12);
}

}  // namespace
}  // namespace chladni::diagnosis
