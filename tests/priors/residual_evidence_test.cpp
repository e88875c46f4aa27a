#include "priors/residual/residual_evidence.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/draw.h"
#include "plate_case.h"
#include "priors/methods/modal_field.h"
#include "priors/residual/orthogonality.h"

namespace chladni::priors {
namespace {

TEST(PooledEvidence, SlopesAreDifferences) {
  const auto made = plate_case("rings", 1, 6);
  const auto basis = modal_basis(made.simulation);
  const Eigen::Vector4d at(std::log(0.12), std::log(6.0), std::log(0.6), std::log(1.2));
  const auto errors_at = [](const Eigen::Vector4d& ln) {
    return ResidualErrors{{std::exp(ln(0)), std::exp(ln(1)), std::exp(ln(2))}, std::exp(ln(3))};
  };
  const auto pooled = pooled_evidence(made.measured, basis, errors_at(at));
  const double step = 1e-5;
  for (int k = 0; k < 4; ++k) {
    Eigen::Vector4d up = at;
    Eigen::Vector4d down = at;
    up(k) += step;
    down(k) -= step;
    const double slope = (pooled_evidence(made.measured, basis, errors_at(up)).log_evidence -
                          pooled_evidence(made.measured, basis, errors_at(down)).log_evidence) /
                         (2.0 * step);
    EXPECT_NEAR(pooled.slopes(k), slope, 1e-4 * (1.0 + std::abs(slope))) << k;
  }
}

TEST(CoefficientPrior, LeavesLessBeyondTheMoreModesThereAre) {
  auto simulation = plate_case("rings", 1, 3).simulation;
  const auto few = modal_basis(simulation);
  const double high = 400.0;
  const double beyond = coefficient_prior(few, high, {}).beyond;
  EXPECT_GT(beyond, 0.0);
  simulation.frequency_hz.conservativeResize(12);
  simulation.surface.shapes.conservativeResize(Eigen::NoChange, 12);
  EXPECT_GT(coefficient_prior(modal_basis(simulation), high, {}).beyond, beyond);
}

TEST(CoefficientPrior, OfAMotionAsAWholeHasRigidBodyModesOnly) {
  const auto basis = modal_basis(plate_case("rings", 1, 3).simulation);
  const auto known = coefficient_prior(basis, 0.0, {});
  EXPECT_EQ(known.variance.head(3).minCoeff(), 1.0);
  EXPECT_EQ(known.variance.tail(known.variance.size() - 3).maxCoeff(), 0.0);
  EXPECT_EQ(known.beyond, 0.0);
}

// A body that is held has no motion as a whole: at 0 Hz it bends as it does just above.
TEST(CoefficientPrior, AtRestOfAHeldBodyIsThatOfLowFrequencies) {
  auto simulation = plate_case("rings", 1, 3).simulation;
  const auto flexible = simulation.mode_count() - 3;
  simulation.frequency_hz = simulation.frequency_hz.tail(flexible).eval();
  simulation.surface.shapes = simulation.surface.shapes.rightCols(flexible).eval();
  const auto basis = modal_basis(simulation);
  const auto rest = coefficient_prior(basis, 0.0, {});
  const auto slow = coefficient_prior(basis, 1e-4 * simulation.frequency_hz(0), {});
  EXPECT_TRUE((rest.variance / rest.variance(0)).isApprox(slow.variance / slow.variance(0), 1e-6));
  EXPECT_GT(rest.beyond, 0.0);
  EXPECT_NEAR(rest.beyond, slow.beyond, 1e-6 * slow.beyond);
}

// Values of a tilting plane, measured at 0 Hz: the field is that plane.
TEST(DynamicResidualField, OfAMotionAsAWholeIsAPlane) {
  auto made = plate_case("rings", 1, 3);
  const auto plane = [](const Places& places) -> Eigen::VectorXd {
    return 0.3 + places.position.col(0).array() - 2.0 * places.position.col(1).array();
  };
  made.measured.frequency_hz(0) = 0.0;
  made.measured.values.col(0) = plane(made.measured.places);
  made.measured.noise.col(0).setConstant(1e-6);
  const auto field =
      mode_field(interpolator("dynamic_residual_alone"), made.measured, made.simulation)
          ->at(made.simulation.surface);
  EXPECT_LT((field.mean.col(0) - plane(made.simulation.surface)).cwiseAbs().maxCoeff(), 1e-4);
}

// Truths drawn from the prior itself: its numbers come back, and its bands cover what they say.
TEST(LearnedErrors, FindWhatShapesWereDrawnFrom) {
  const auto one = plate_case("rings", 1, 12);
  const auto basis = modal_basis(one.simulation);
  const DynamicResidual drawn{0.06, 12.0, 0.7};
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double covered = 0.0;
  const int repeats = 8;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    Draw draw(static_cast<unsigned>(50 + repeat));
    auto made = one;
    for (Eigen::Index i = 0; i < 12; ++i) {
      const double hz = std::sqrt(0.7) * basis.frequency_hz(3 + i) * (1.0 + 0.02 * draw.normal());
      Eigen::VectorXd c = coefficient_variances(basis.frequency_hz, hz, drawn).cwiseSqrt();
      for (double& x : c) x *= draw.normal();
      made.measured.frequency_hz(i) = hz;
      made.truth.col(i) = made.simulation.surface.shapes * c;
      made.measured.values.col(i) = made.measured.places.shapes * c;
      const double sigma = 0.01 * made.measured.values.col(i).norm() / std::sqrt(13.0);
      made.measured.noise.col(i).setConstant(sigma);
      for (double& x : made.measured.values.col(i)) x += sigma * draw.normal();
    }
    const auto learned = learned_errors(made.measured, basis).errors.prior;
    mean +=
        Eigen::Vector3d(std::log(learned.eta / drawn.eta), std::log(learned.kappa / drawn.kappa),
                        std::log(learned.gamma / drawn.gamma)) /
        repeats;
    const auto field =
        mode_field(interpolator("dynamic_residual_alone"), made.measured, made.simulation)
            ->at(made.simulation.surface);
    covered += coverage(field, made.truth, made.simulation.area).mean() / repeats;
  }
  EXPECT_LT(std::abs(mean(0)), 0.5);
  EXPECT_LT(std::abs(mean(1)), 0.7);
  EXPECT_LT(std::abs(mean(2)), 0.05);
  EXPECT_GT(covered, 0.92);
  EXPECT_LT(covered, 0.98);
}

TEST(LearnedErrors, DoubtADataSetThatNoPlausibleErrorExplains) {
  auto made = plate_case("rings", 1, 12);
  Draw draw(9);
  for (double& value : made.measured.values.reshaped()) value = draw.normal();
  const auto learned = learned_errors(made.measured, modal_basis(made.simulation));
  EXPECT_FALSE(learned.doubts.empty());
}

TEST(Orthogonality, LeavesShapesAloneThatAreOrthogonal) {
  std::vector<ShapeCoefficients> shapes(3);
  for (Eigen::Index i = 0; i < 3; ++i) {
    auto& shape = shapes[static_cast<std::size_t>(i)];
    shape.mean = Eigen::VectorXd::Unit(6, i);
    shape.root = 0.1 * Eigen::MatrixXd::Identity(6, 6);
  }
  const auto known = orthogonal_shapes(shapes);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT((known[i].mean - shapes[i].mean).norm(), 1e-12);
    EXPECT_LE((known[i].root * known[i].root.transpose()).trace(), 0.06 + 1e-12);
  }
}

// A sharp shape tells a vague one what it cannot be.
TEST(Orthogonality, TakesFromAVagueShapeWhatIsInASharpOne) {
  std::vector<ShapeCoefficients> shapes(2);
  shapes[0] = {Eigen::Vector2d(1.0, 0.0), 1e-4 * Eigen::Matrix2d::Identity(), 0.0};
  shapes[1] = {Eigen::Vector2d(0.5, 1.0), 0.5 * Eigen::Matrix2d::Identity(), 0.0};
  const auto known = orthogonal_shapes(shapes, {.tolerance = 0.02, .sweeps = 3});
  EXPECT_LT(std::abs(known[1].mean(0)), 0.01);
  EXPECT_NEAR(known[1].mean(1), 1.0, 1e-6);
  EXPECT_LT((known[0].mean - shapes[0].mean).norm(), 1e-3);
}

TEST(Orthogonality, LearnsHowFarProductsAreFromZero) {
  for (const double spread : {0.05, 0.3}) {
    Draw draw(4);
    std::vector<ShapeCoefficients> shapes;
    for (Eigen::Index i = 0; i < 12; ++i) {
      ShapeCoefficients shape{Eigen::VectorXd::Unit(12, i),
                              1e-3 * Eigen::MatrixXd::Identity(12, 12), 0.0};
      for (Eigen::Index j = 0; j < i; ++j) shape.mean(j) = spread * draw.normal();
      shapes.push_back(shape);
    }
    const double tolerance = learned_tolerance(shapes);
    EXPECT_GT(tolerance, 1.2 * spread);
    EXPECT_LT(tolerance, 3.0 * spread);
  }
}

}  // namespace
}  // namespace chladni::priors
