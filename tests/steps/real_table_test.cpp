// models/oat/interpolation: the pocketed table of tetrahedra as the truth, the plain plate as the
// model. docs/reference/oat_interpolation.md shows the figures.
#include <gtest/gtest.h>

#include "rotation/turn.h"
#include "steps/interpolation.h"
#include "steps/priors.h"
#include "tests/app/quiet_run.h"

namespace chladni::steps {
namespace {

steps::Interpolated result_of(const std::string& name) {
  const app::TestFolder folder("real_table");
  const study::Study study = study::read_study(std::filesystem::path(CHLADNI_SOURCE_DIR) /
                                               "models" / "oat" / "interpolation" / name);
  app::QuietRun quiet(study, folder.path());
  const stage::Solution solution = stage::solved(study, quiet.run());
  return steps::interpolated(study, solution, quiet.run());
}

TEST(RealTable, OfTetrahedraWithRibsIsKnownFromThirteenSensors) {
  EVERY_FOURTH_LANDING();
  const auto result = result_of("rings.toml");
  const auto& ours = result.methods.front();
  EXPECT_LT(ours.error.head(9).mean(), 0.005);
  EXPECT_LT(ours.error.maxCoeff(), 0.03);
  EXPECT_GT(ours.covered.mean(), 0.90);
  EXPECT_LT(ours.covered.mean(), 0.98);
  for (std::size_t k = 1; k < result.methods.size(); ++k) {
    EXPECT_LT(20.0 * ours.error.mean(), result.methods[k].error.mean());
  }
}

// The thesis' own places lie on mirror lines: three shapes near 1230 Hz are not told apart, the
// others are; what two channels would have measured is predicted.
TEST(RealTable, IsPredictedWhereItsOwnChannelsAreLeftOut) {
  EVERY_FOURTH_LANDING();
  const auto result = result_of("study.toml");
  const auto& ours = result.methods.front();
  EXPECT_LT(ours.error.head(6).maxCoeff(), 0.002);
  EXPECT_LT(ours.hidden_error.maxCoeff(), 0.05);
  EXPECT_LT(ours.hidden_frf_error.maxCoeff(), 0.05);
  EXPECT_GT(ours.hidden_covered.mean(), 0.85);
  // 15: odd about all mirror lines.
  EXPECT_GT(result.expected_error(14), 0.3);
}

// What the thesis saw fall, and what falls only there: the error of the most complex mode as more
// samples are learned from; a simpler one rises meanwhile, along the same ridge.
TEST(Figure512, IsWhereARidgeEndsAndNoMatterOfTheModel) {
  EVERY_FOURTH_LANDING();
  const app::TestFolder folder("figure_5_12");
  const study::Study study =
      study::read_study(std::filesystem::path(CHLADNI_SOURCE_DIR) / "models" / "oat" /
                        "interpolation" / "figure_5_12_minimal.toml");
  app::QuietRun quiet(study, folder.path());
  const stage::Solution solution = stage::solved(study, quiet.run());
  const auto result = steps::learned_priors(study, solution, quiet.run());
  const auto error = [&](std::size_t at, Eigen::Index mode) {
    return result.by_samples[at].channel_error(mode - 1);
  };
  ASSERT_EQ(result.by_samples.size(), 7U);
  EXPECT_LT(error(6, 12), 0.5 * error(2, 12));
  EXPECT_GT(error(6, 8), 3.0 * error(2, 8));
  EXPECT_NEAR(error(6, 9), 1.0, 1e-3);  // odd about all mirror lines: nothing is seen of it
  EXPECT_GT(result.last().noise_dependence.minCoeff(), 0.05);
  ASSERT_EQ(result.spline_error.size(), 3U);
  EXPECT_GT(result.spline_error[2].second(11), 0.9);  // leave-one-out flattens it
}

}  // namespace
}  // namespace chladni::steps
