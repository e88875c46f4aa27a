// What may be wrong of a body, against a body of which it is wrong.
#include "stage/corrections.h"

#include <gtest/gtest.h>

#include <cmath>

#include "priors/residual/corrections.h"
#include "tests/app/quiet_run.h"

namespace chladni::stage {
namespace {

constexpr const char* kPlate = R"(title = "plate"
geometry = { plate = { length = "600 mm", width = "400 mm", thickness = "20 mm" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "60 mm", order = 2 }
modes = { count = 40, damping_ratio = 0.005 }
)";

stage::Solution solved_with(const std::string& text) {
  const app::TestFolder folder("corrections");
  const study::Study study = study::parse_study(text, "study.toml");
  app::QuietRun quiet(study, folder.path());
  return stage::solved(study, quiet.run());
}

const stage::Solution& plate() {
  static const stage::Solution solution = solved_with(kPlate);
  return solution;
}

TEST(Corrections, AreSymmetricAndLeaveRigidMotionsUnstrained) {
  const auto all = stage::corrections(plate());
  EXPECT_EQ(all.size(), 15U + 3U + 48U);  // waves, anisotropy, 8×6 masses
  const auto m = plate().modes.frequency_hz.size();
  for (const auto& one : all) {
    EXPECT_GT(one.deviation, 0.0) << one.name;
    const auto& matrix = one.stiffness.size() > 0 ? one.stiffness : one.mass;
    ASSERT_EQ(matrix.rows(), m) << one.name;
    EXPECT_LE((matrix - matrix.transpose()).cwiseAbs().maxCoeff(),
              1e-12 * matrix.cwiseAbs().maxCoeff())
        << one.name;
    if (one.stiffness.size() > 0) {
      EXPECT_EQ(one.stiffness.topRows(6).norm(), 0.0) << one.name;
    }
  }
}

// The frequencies that a correction predicts against those of a body that is like this.
void expect_frequencies(const stage::Solution& real, const std::string& name, double parameter,
                        double tolerance) {
  const auto all = stage::corrections(plate());
  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(all.size()));
  for (std::size_t f = 0; f < all.size(); ++f) {
    if (all[f].name == name) parameters(static_cast<Eigen::Index>(f)) = parameter;
  }
  ASSERT_GT(parameters.norm(), 0.0) << name;
  const auto found = priors::corrected_modes(plate().modes.frequency_hz, all, parameters).value();
  for (Eigen::Index j = 6; j < 12; ++j) {
    const double before = plate().modes.frequency_hz(j);
    const double after = real.modes.frequency_hz(j);
    EXPECT_NEAR(found.frequency_hz(j), after, tolerance * after) << "before: " << before;
  }
  EXPECT_GT((real.modes.frequency_hz - plate().modes.frequency_hz).segment(6, 6).norm(),
            0.01 * plate().modes.frequency_hz.segment(6, 6).norm());
}

TEST(Corrections, PredictAMassAtACorner) {
  const auto real = solved_with(std::string(kPlate) + R"([[attachment]]
kind = "mass"
name = "corner"
mass = "0.4 kg"
at = ["300 mm", "200 mm"]
)");
  const auto all = stage::corrections(plate());
  std::string corner;
  for (const auto& one : all) {
    if (one.name.starts_with("kg at (0.300, 0.200")) corner = one.name;
  }
  expect_frequencies(real, corner, 0.4, 0.01);
}

}  // namespace
}  // namespace chladni::stage
