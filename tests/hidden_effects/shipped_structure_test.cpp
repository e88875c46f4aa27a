// Tetrahedra against the plates of tests/simulators: the same rigs by two laws.
#include "hidden_effects/shipped_structure.h"

#include <gtest/gtest.h>

#include <vector>

#include "rotation/turn.h"
#include "simulators/hidden/hidden_effect.h"
#include "simulators/rigs/real_body.h"

namespace chladni::hidden_effects {
namespace {

// Frequencies of the modes within the band that the sensors see.
std::vector<double> seen_frequencies(const diagnosis::Structure& structure,
                                     const simulators::Rig& rig) {
  const double most = structure.outputs.shapes.cwiseAbs().maxCoeff();
  std::vector<double> all;
  for (Eigen::Index k = structure.rigid_count; k < structure.mode_count(); ++k) {
    const bool seen = structure.outputs.shapes.col(k).cwiseAbs().maxCoeff() > 0.02 * most;
    const double hz = structure.frequency_hz(k);
    if (seen && hz > rig.low_hz && hz < rig.high_hz) all.push_back(hz);
  }
  return all;
}

class ShippedStructure : public testing::TestWithParam<std::string> {};

TEST_P(ShippedStructure, HasTheModesOfTheTruth) {
  const auto rig = simulators::rig_named(GetParam());
  const auto made = shipped(rig);
  const auto& truth = simulators::believed_modes(GetParam());
  const auto frequencies = seen_frequencies(made.structure, rig);
  EXPECT_GE(frequencies.size(), 4U);
  for (const double hz : frequencies) {
    const double nearest = (truth.frequency_hz.array() - hz).abs().minCoeff();
    EXPECT_LT(nearest, 2e-3 * hz) << hz;
  }
}

INSTANTIATE_TEST_SUITE_P(Rigs, ShippedStructure, testing::Values("table_few", "strip"),
                         [](const auto& info) { return info.param; });

class ShippedRealBody : public testing::TestWithParam<std::string> {};

// The truth of a disc and an L is a thin plate, up to 1.8 % from the solid; the coils of a strip
// differ.
TEST_P(ShippedRealBody, HasTheModesOfTheTruth) {
  EVERY_FOURTH_LANDING();
  const auto body = simulators::real_body(GetParam());
  const auto made = shipped(body.rig);
  const auto& truth = simulators::believed_modes(body);
  EXPECT_NEAR(made.structure.mass_kg, body.mass, 2e-3 * body.mass);
  const auto frequencies = seen_frequencies(made.structure, body.rig);
  EXPECT_GE(frequencies.size(), 4U);
  for (const double hz : frequencies) {
    const double nearest = (truth.frequency_hz.array() - hz).abs().minCoeff();
    EXPECT_LT(nearest, 0.02 * hz) << hz;
  }
}

INSTANTIATE_TEST_SUITE_P(Bodies, ShippedRealBody, testing::Values("table", "strip", "disc", "ell"),
                         [](const auto& body) { return body.param; });

}  // namespace
}  // namespace chladni::hidden_effects
