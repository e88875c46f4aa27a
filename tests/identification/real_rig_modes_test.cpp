// Complex modes of rigs that have what no model has: strings, cables, a frame, dampings that are
// not proportional. The truth is a plate by the method of Ritz.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "identification/identified.h"
#include "identification/poles/missing_mode.h"
#include "rotation/turn.h"
#include "simulators/rigs/real_rig.h"

namespace chladni::identification {
namespace {

IdentificationOptions with_complex_modes() {
  IdentificationOptions options;
  options.rigid_count = -1;
  options.fit.delay = true;
  options.fit.damping = Damping::general;
  return options;
}

// Σ |w (G − Ĝ)|² of the model as it is handed out.
double cost_of(const ModalFit& fit, const FitData& data) {
  return (data.value - responses(fit, data.frequency_hz))
      .cwiseProduct(data.weight.cast<std::complex<double>>())
      .squaredNorm();
}

class ComplexModesOfARig : public testing::TestWithParam<const char*> {};

// The pole of a mode that is nearly critically damped lost the digits of its ω_d, and the responses
// of the model were eleven times too large beside a fit down to the noise.
TEST_P(ComplexModesOfARig, HaveTheResponsesOfTheirCost) {
  EVERY_FOURTH_LANDING();
  const auto data = fit_data(simulators::real_rig_case(GetParam(), "none", 1).measured);
  const auto fit = identified(data, with_complex_modes()).fit;
  EXPECT_NEAR(cost_of(fit, data) / fit.cost, 1.0, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Bodies, ComplexModesOfARig, testing::Values("strip", "ell"),
                         [](const auto& one) { return std::string(one.param); });

// A start that keeps what is fitted ends no higher, by itself and beside one more mode. Fitted anew
// from the poles alone complex residues have no single direction, and the cost became 1e8 times
// larger.
TEST(StartOfAFit, NeverRaisesTheCost) {
  auto options = with_complex_modes();
  options.fit.delay = false;
  const auto data = fit_data(simulators::real_rig_case("strip", "none", 1).measured);
  options.modes = 5;
  const auto few = identified(data, options).fit;
  ASSERT_TRUE(few.complex);
  EXPECT_LT(modal_fit(data, start_of(few), options.fit).cost, (1.0 + 1e-9) * few.cost);
  auto start = start_of(few);
  const auto missing = missing_mode(data, few);
  start.pole.conservativeResize(start.pole.size() + 1);
  start.pole(start.pole.size() - 1) = missing.pole;
  start.general.push_back(missing.general);
  const auto more = modal_fit(data, start, options.fit);
  EXPECT_EQ(more.flexible_count(), few.flexible_count() + 1);
  EXPECT_LT(more.cost, few.cost);
}

}  // namespace
}  // namespace chladni::identification
