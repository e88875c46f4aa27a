#include "simulators/tables/real_tables.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>

#include "base/error.h"
#include "rotation/turn.h"
#include "simulators/portable_random.h"
#include "simulators/tables/plate_study.h"

namespace chladni::simulators {
namespace {

double first_hz(const KirchhoffPlate& table) { return plate_modes(table, 1).frequency_hz(3); }

TEST(RealTables, AreLowerThanThePlateAloneByTheirMasses) {
  EVERY_FOURTH_LANDING();
  EXPECT_NEAR(first_hz(minimal_table()), 183.5, 0.05);
  EXPECT_NEAR(first_hz(minimal_table_with_corner_masses()), 147.6, 0.5);
  EXPECT_NEAR(first_hz(accurate_table()), 127.4, 0.5);
  for (const unsigned seed : {1U, 7U, 20U}) {
    EXPECT_GT(first_hz(real_table(seed)), 121.0) << seed;
    EXPECT_LT(first_hz(real_table(seed)), 132.0) << seed;
  }
}

TEST(RealTables, AreTheSameForTheSameSeedAndDifferOtherwise) {
  const auto one = real_table(4);
  EXPECT_EQ(one.areal_mass, real_table(4).areal_mass);
  EXPECT_GT((one.areal_mass - real_table(5).areal_mass).norm(), 0.03 * one.areal_mass.norm());
  // The generator itself, to the bit, so that a study can be repeated anywhere.
  Dice dice(1);
  EXPECT_DOUBLE_EQ(dice.uniform(), 0.41702200470257400);
}

TEST(RealTables, HaveLayoutsOnTheMounts) {
  for (const auto* name : {"quincunx", "rings", "rand1", "rand2"}) {
    const auto places = layout(name);
    ASSERT_EQ(places.rows(), 13) << name;
    for (Eigen::Index a = 0; a < 13; ++a) {
      EXPECT_LT((mounts().rowwise() - places.row(a)).rowwise().norm().minCoeff(), 1e-12);
      for (Eigen::Index b = 0; b < a; ++b) {
        EXPECT_GT((places.row(a) - places.row(b)).norm(), 0.05) << name;
      }
    }
  }
  EXPECT_THROW((void)layout("spiral"), InvalidInput);
  EXPECT_THROW((void)real_table(1, 0.5), InvalidInput);
}

// √Σ φ² over the 13 places, for shapes of rms 1. A shape that is evenly seen has √13 = 3.6.
TEST(RealTables, HaveRingsThatSeeEveryModeAndAQuincunxThatMissesTheNinth) {
  const auto modes = plate_modes(minimal_table(), 12);
  const auto surface = plate_surface(modes, 2);
  const Eigen::VectorXd scale = unit_rms(shapes_at(modes, surface.places), surface.area);
  const auto seen = [&](const char* name) {
    const Eigen::MatrixXd shapes = shapes_at(modes, layout(name)) * scale.asDiagonal();
    return Eigen::MatrixXd(shapes.rightCols(12));
  };
  EXPECT_GT(seen("rings").colwise().norm().minCoeff(), 2.0);
  EXPECT_GT(Eigen::JacobiSVD<Eigen::MatrixXd>(seen("rings")).singularValues()(11), 1.0);
  EXPECT_LT(seen("quincunx").col(8).norm(), 1e-6);
}

TEST(RealTables, GiveTestsWhoseNoiseIsWhatWasAskedFor) {
  const auto truth = plate_modes(real_table(1), 12);
  const auto believed = plate_modes(minimal_table(), 20);
  const auto surface = plate_surface(truth);
  const auto quiet = plate_test(truth, believed, surface, mounts(), 12, 1e-12, 1);
  const auto noisy = plate_test(truth, believed, surface, mounts(), 12, 0.01, 1);
  const Eigen::MatrixXd noise = noisy.measured.values - quiet.measured.values;
  EXPECT_NEAR(noise.norm() / std::sqrt(81.0 * 12.0), 0.01, 0.0007);
  EXPECT_EQ(noisy.measured.places.shapes.cols(), 23);
  const Eigen::VectorXd square =
      noisy.truth.array().square().matrix().transpose() * surface.area / surface.area.sum();
  EXPECT_LT((square.array() - 1.0).abs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace chladni::simulators
