// What a sound model may be off by over frequency, against models that are drawn.
#include "diagnosis/error_band.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/draw.h"
#include "diagnosis/fit/deviations.h"
#include "diagnosis/fit/fit.h"
#include "diagnosis/fit/sensitivities.h"
#include "diagnosis/small_plate.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::VectorXd;

// The plate's own responses, with a deviation of a hundredth.
modal::FrfSet exact_responses() {
  const auto& plate = small_plate();
  modal::FrfSet set;
  for (const auto& name : plate.outputs.names) set.outputs.emplace_back().name = name;
  for (const auto& name : plate.inputs.names) set.inputs.emplace_back().name = name;
  set.frequency_hz = VectorXd::LinSpaced(150, 31.0, 893.0);
  const auto all = responses(state_of(plate), 2.0 * 3.14159265358979 * set.frequency_hz);
  for (Index k = 0; k < all.rows(); ++k) {
    set.value.emplace_back(
        all.row(k).transpose().reshaped(plate.output_count(), plate.input_count()));
    set.variance.emplace_back(1e-4 * set.value.back().cwiseAbs2());
  }
  return set;
}

TEST(ErrorBand, OfAModelThatIsExactIsNoise) {
  const auto set = exact_responses();
  const auto band = error_band(small_plate(), set, no_tolerances());
  ASSERT_EQ(band.frequency_hz.size(), 150);
  EXPECT_TRUE(band.frequency_hz.isApprox(set.frequency_hz, 1e-12));
  EXPECT_TRUE(band.model.isZero(0.0));
  for (Index k = 0; k < 150; ++k) {
    const double size = set.value[static_cast<std::size_t>(k)].squaredNorm();
    EXPECT_NEAR(band.noise(k), 1e-4 * size, 1e-12 * size);
  }
}

// Gains, frequencies and dampings that are drawn: the mean square of what they change.
TEST(ErrorBand, IsWhatSmallDeviationsDoInTheMean) {
  const auto& plate = small_plate();
  const auto set = exact_responses();
  auto tolerances = no_tolerances();
  tolerances.gain = 2e-3;
  tolerances.frequency = 1e-4;
  tolerances.damping = 0.01;
  const auto band = error_band(plate, set, tolerances);
  const auto given = deviations(plate, tolerances, 3.0 * 893.0);
  const Observed observed = seen(plate, set, 1e4).observed;
  const Problem problem{plate, observed, given};
  const MatrixXcd rest = responses(state_of(plate), observed.omega);
  VectorXd sum = VectorXd::Zero(150);
  Draw draw(3);
  constexpr int kDraws = 200;
  for (int n = 0; n < kDraws; ++n) {
    VectorXd eta(std::ssize(given));
    for (Index i = 0; i < eta.size(); ++i) eta(i) = draw.normal();
    sum += (responses(state_of(problem, {}, eta), observed.omega) - rest).rowwise().squaredNorm();
  }
  // A mean of 200 squares scatters by a tenth where one number decides.
  for (Index k = 0; k < 150; ++k) {
    EXPECT_NEAR(std::sqrt(sum(k) / kDraws / band.model(k)), 1.0, 0.2) << band.frequency_hz(k);
  }
  EXPECT_NEAR((sum / kDraws).cwiseQuotient(band.model).mean(), 1.0, 0.1);
}

// A resonance that may be anywhere makes no response wrong by many times its size.
TEST(ErrorBand, IsBoundedWhereResonancesMayBeAnywhere) {
  const auto set = exact_responses();
  auto tolerances = no_tolerances();
  tolerances.frequency = 0.3;
  const auto band = error_band(small_plate(), set, tolerances);
  for (Index k = 0; k < 150; ++k) {
    const double size = set.value[static_cast<std::size_t>(k)].squaredNorm();
    EXPECT_LT(band.model(k), 24.0 * size);  // of as many modes
  }
}

}  // namespace
}  // namespace chladni::diagnosis
