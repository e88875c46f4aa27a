// Measured data in the form that a diagnosis uses.
#include "diagnosis/observed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

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

}  // namespace
}  // namespace chladni::diagnosis
