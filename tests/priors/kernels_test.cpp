// Laws that every kernel keeps, over the whole table and what is made of it.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <random>

#include "base/error.h"
#include "priors/gaussian_process/exponential.h"
#include "priors/kernel.h"

namespace chladni::priors {
namespace {

constexpr unsigned kKernelSeed = 20;

// Points that fill `dimensions` axes, one of them twice.
Points kernel_points(Eigen::Index count, int dimensions, unsigned seed = kKernelSeed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-0.3, 0.3);
  Points points = Points::Constant(count, 3, 0.02);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (int a = 0; a < dimensions; ++a) points(i, a) = uniform(random);
  }
  points.row(count - 1) = points.row(0);
  return points;
}

Eigen::VectorXd some_parameters(const Kernel& kernel) {
  Eigen::VectorXd values(kernel.parameter_count());
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const bool is_length = kernel.parameters()[static_cast<std::size_t>(k)].unit == "m";
    values(k) = (is_length ? 0.17 : 0.9) * (1.0 + 0.15 * static_cast<double>(k));
  }
  return values;
}

Eigen::MatrixXd whole_covariance(const Eigen::MatrixXd& lower) {
  return lower.selfadjointView<Eigen::Lower>();
}

double maximum(const Eigen::MatrixXd& matrix) { return matrix.cwiseAbs().maxCoeff(); }

// The symmetries of a square about `centre`, of a shape that is even or odd in x and in y and turns
// its sign, or not, where they are exchanged.
Symmetry square(double x, double y, double exchanged) {
  Symmetry symmetry;
  symmetry.centre << 0.02, -0.01, 0.0;
  for (const bool swap : {false, true}) {
    for (const double sx : {1.0, -1.0}) {
      for (const double sy : {1.0, -1.0}) {
        Eigen::Matrix3d q = Eigen::Vector3d(sx, sy, 1.0).asDiagonal();
        if (swap) q.row(0).swap(q.row(1));
        symmetry.operations.push_back(q);
        symmetry.characters.push_back((sx < 0 ? x : 1.0) * (sy < 0 ? y : 1.0) *
                                      (swap ? exchanged : 1.0));
      }
    }
  }
  return symmetry;
}

struct Case {
  std::string name;
  std::function<Kernel()> kernel;
};

void PrintTo(const Case& one, std::ostream* stream) { *stream << one.name; }

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const auto* family : kernels()) {
    const std::string name(family->name);
    all.push_back({name, [family] { return Kernel(*family); }});
    all.push_back({name + "_per_axis", [family] { return Kernel(*family, Scales::per_axis); }});
    all.push_back({name + "_weighted", [family] { return weighted(Kernel(*family)); }});
    all.push_back({name + "_plus_linear",
                   [family] { return Kernel(*family) + weighted(kernel_family("linear")); }});
    all.push_back({name + "_times_periodic", [family] {
                     return Kernel(*family, Scales::per_axis) * Kernel(kernel_family("periodic"));
                   }});
    if (!family->is_isotropic) continue;
    all.push_back({name + "_symmetrised_even",
                   [family] { return symmetrised(*family, square(1.0, 1.0, 1.0)); }});
    all.push_back({name + "_symmetrised_odd",
                   [family] { return symmetrised(*family, square(-1.0, -1.0, -1.0), 0.15); }});
  }
  return all;
}

class EveryKernel : public ::testing::TestWithParam<Case> {
 protected:
  Kernel kernel_ = GetParam().kernel();
  Eigen::VectorXd values_ = some_parameters(kernel_);
};

TEST_P(EveryKernel, IsSymmetric) {
  const auto points = kernel_points(20, 3);
  const auto others = kernel_points(15, 3, kKernelSeed + 1);
  const auto there = covariance(kernel_, values_, points, others);
  const auto back = covariance(kernel_, values_, others, points);
  EXPECT_LT(maximum(there - back.transpose()), 1e-13);
}

TEST_P(EveryKernel, IsPositiveSemidefinite) {
  for (const int dimensions : {1, 2, 3}) {
    for (const double stretch : {0.2, 1.0, 8.0}) {
      const auto points = kernel_points(40, dimensions);
      const auto matrix = covariance(kernel_, stretch * values_, points);
      const Eigen::VectorXd eigenvalues =
          Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly)
              .eigenvalues();
      EXPECT_GT(eigenvalues.minCoeff(), -1e-13 * eigenvalues.maxCoeff())
          << dimensions << " dimensions, parameters times " << stretch;
    }
  }
}

TEST_P(EveryKernel, IsTheSameForTwoSetsAndForOne) {
  const auto points = kernel_points(20, 3);
  const auto square = covariance(kernel_, values_, points);
  EXPECT_EQ(maximum(square.triangularView<Eigen::StrictlyUpper>()), 0.0);
  EXPECT_LT(maximum(whole_covariance(square) - covariance(kernel_, values_, points, points)),
            1e-14);
}

TEST_P(EveryKernel, HasTheVarianceOnItsDiagonal) {
  const auto points = kernel_points(20, 3);
  const Eigen::VectorXd diagonal = covariance(kernel_, values_, points).diagonal();
  EXPECT_LT(maximum(diagonal - variances(kernel_, values_, points)), 1e-14);
}

TEST_P(EveryKernel, HasTheGradientOfItsDifferences) {
  const auto points = kernel_points(12, 3);
  std::mt19937 random(kKernelSeed);
  std::normal_distribution<double> normal;
  const auto draw = [&] { return normal(random); };
  Eigen::MatrixXd weights = Eigen::MatrixXd::NullaryExpr(12, 12, draw);
  weights += weights.transpose().eval();
  const Eigen::MatrixXd vectors = Eigen::MatrixXd::NullaryExpr(12, 3, draw);
  const auto exact = contractions(kernel_, values_, points, weights, vectors);
  const double h = 1e-4;
  for (Eigen::Index k = 0; k < values_.size(); ++k) {
    const auto at = [&](double log_change) {
      Eigen::VectorXd changed = values_;
      changed(k) *= std::exp(log_change);
      return whole_covariance(covariance(kernel_, changed, points));
    };
    const Eigen::MatrixXd slope =  // the error is h^4 / 30 of the fifth derivative
        (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
    EXPECT_NEAR(exact.weighted(k), slope.cwiseProduct(weights).sum(), 2e-8) << k;
    for (Eigen::Index i = 0; i < vectors.cols(); ++i) {
      EXPECT_NEAR(exact.forms(k, i), vectors.col(i).dot(slope * vectors.col(i)), 2e-8) << k;
    }
  }
}

TEST_P(EveryKernel, DoesNotChangeWhenAllIsMovedWhereItIsStationary) {
  const auto points = kernel_points(20, 3);
  const Eigen::RowVector3d shift(0.11, -0.07, 0.05);
  const Points moved = points.rowwise() + shift;
  const double change =
      maximum(covariance(kernel_, values_, moved) - covariance(kernel_, values_, points));
  if (kernel_.is_stationary()) {
    EXPECT_LT(change, 1e-12);
  } else {
    EXPECT_GT(change, 1e-6);
  }
}

TEST_P(EveryKernel, DoesNotChangeWhenAllIsTurnedWhereItIsIsotropic) {
  const auto points = kernel_points(20, 3);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, -2, 3).normalized()).toRotationMatrix();
  const Points turned = points * turn.transpose();
  const double change =
      maximum(covariance(kernel_, values_, turned) - covariance(kernel_, values_, points));
  if (!kernel_.is_isotropic()) return;
  EXPECT_LT(change, 1e-12);
}

TEST_P(EveryKernel, DoesNotChangeWithTheUnitOfLength) {
  const auto points = kernel_points(20, 3);
  if (GetParam().name.find("symmetrised") != std::string::npos) return;  // its centre is in metres
  Eigen::VectorXd millimetres = values_;
  for (Eigen::Index k = 0; k < values_.size(); ++k) {
    if (kernel_.parameters()[static_cast<std::size_t>(k)].unit == "m") millimetres(k) *= 1e3;
  }
  const Points large = 1e3 * points;
  EXPECT_LT(maximum(covariance(kernel_, millimetres, large) - covariance(kernel_, values_, points)),
            1e-10);
}

TEST_P(EveryKernel, RefusesParametersThatAreNotItsOwn) {
  const auto points = kernel_points(4, 2);
  EXPECT_THROW((void)covariance(kernel_, Eigen::VectorXd::Ones(17), points), InvalidInput);
  EXPECT_THROW((void)covariance(kernel_, -values_, points), InvalidInput);
}

std::string name_of(const ::testing::TestParamInfo<Case>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(Kernels, EveryKernel, ::testing::ValuesIn(cases()), name_of);

class EverySymmetry : public ::testing::TestWithParam<Case> {};

// f(g x) = χ f(x) for every function of the prior: k(g x, x') = χ k(x, x').
TEST_P(EverySymmetry, IsKeptByTheKernel) {
  for (const auto& symmetry :
       {square(1, 1, 1), square(1, 1, -1), square(-1, -1, 1), square(-1, -1, -1)}) {
    const auto kernel = symmetrised(GetParam().kernel(), symmetry);
    const auto values = some_parameters(kernel);
    const auto points = kernel_points(15, 3);
    const auto others = kernel_points(10, 3, kKernelSeed + 1);
    const auto before = covariance(kernel, values, points, others);
    for (std::size_t g = 0; g < symmetry.operations.size(); ++g) {
      const Points image =
          ((points.rowwise() - symmetry.centre) * symmetry.operations[g].transpose()).rowwise() +
          symmetry.centre;
      const auto after = covariance(kernel, values, image, others);
      EXPECT_LT(maximum(after - symmetry.characters[g] * before), 1e-12) << g;
    }
  }
}

std::vector<Case> isotropic_cases() {
  std::vector<Case> some;
  for (const auto* family : kernels()) {
    if (!family->is_isotropic) continue;
    some.push_back({std::string(family->name), [family] { return Kernel(*family); }});
  }
  return some;
}

INSTANTIATE_TEST_SUITE_P(Kernels, EverySymmetry, ::testing::ValuesIn(isotropic_cases()), name_of);

TEST(Exponentiate, IsTheExponentialToItsLastDigits) {
  Eigen::ArrayXd x(100003);  // no multiple of what a register holds
  for (Eigen::Index i = 0; i < x.size(); ++i)
    x(i) = -690.0 * std::pow(static_cast<double>(i) / 100002.0, 3.0);
  Eigen::ArrayXd found = x;
  exponentiate(found);
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    ASSERT_NEAR(found(i) / std::exp(x(i)), 1.0, 5e-16) << x(i);
  }
  EXPECT_EQ(found(0), 1.0);
  Eigen::ArrayXd far = Eigen::ArrayXd::Constant(3, -1e6);
  exponentiate(far);
  EXPECT_LT(far(2), 1e-299);
  EXPECT_GE(far(2), 0.0);
}

TEST(Kernel, OfTheSourceHasItsFormula) {
  const Points points = (Points(2, 3) << 0.1, 0.2, 0.0, 0.4, 0.6, 0.0).finished();
  const Eigen::VectorXd length = Eigen::VectorXd::Constant(1, 0.25);
  const auto k = covariance(kernel_family("squared_exponential"), length, points);
  EXPECT_NEAR(k(1, 0), std::exp(-0.5 * 0.25 / (0.25 * 0.25)), 1e-15);
}

TEST(Kernel, MaternsLieBetweenTheExponentialAndTheSquaredExponential) {
  const Points points = (Points(2, 3) << 0, 0, 0, 0.1, 0, 0).finished();
  const Eigen::VectorXd length = Eigen::VectorXd::Constant(1, 0.2);
  const double rough = covariance(kernel_family("matern_3_2"), length, points)(1, 0);
  const double smoother = covariance(kernel_family("matern_5_2"), length, points)(1, 0);
  const double smooth = covariance(kernel_family("squared_exponential"), length, points)(1, 0);
  EXPECT_LT(std::exp(-0.5), rough);
  EXPECT_LT(rough, smoother);
  EXPECT_LT(smoother, smooth);
}

TEST(Kernel, RationalQuadraticOfManyScalesIsTheSquaredExponential) {
  const auto points = kernel_points(10, 2);
  const auto quadratic =
      covariance(kernel_family("rational_quadratic"), Eigen::Vector2d(0.2, 1e7), points);
  const auto exponential =
      covariance(kernel_family("squared_exponential"), Eigen::VectorXd::Constant(1, 0.2), points);
  EXPECT_LT(maximum(quadratic - exponential), 1e-6);
}

TEST(Kernel, PeriodicAndCosineRepeatThemselves) {
  for (const auto* name : {"periodic", "cosine"}) {
    const Kernel kernel(kernel_family(name));
    Eigen::VectorXd values = some_parameters(kernel);
    values(0) = 0.2;
    const auto points = kernel_points(10, 2);
    const Points moved = points.rowwise() + Eigen::RowVector3d(0.2, -0.4, 0.0);
    EXPECT_LT(maximum(covariance(kernel, values, points, points) -
                      covariance(kernel, values, points, moved)),
              1e-12)
        << name;
  }
}

TEST(Kernel, SymmetrisedRefusesWhatIsNoGroup) {
  const Kernel kernel(kernel_family("squared_exponential"));
  Symmetry turns;
  turns.operations = {Eigen::Matrix3d::Identity(),
                      Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitZ()).toRotationMatrix()};
  turns.characters = {1.0, 1.0};
  EXPECT_THROW((void)symmetrised(kernel, turns), InvalidInput);
  Symmetry wrong = square(1, 1, 1);
  wrong.characters[3] = -1.0;
  EXPECT_THROW((void)symmetrised(kernel, wrong), InvalidInput);
  EXPECT_THROW((void)symmetrised(kernel, square(-1, 1, 1)), InvalidInput);
  EXPECT_THROW((void)symmetrised(kernel_family("linear"), square(1, 1, 1)), InvalidInput);
  EXPECT_THROW((void)symmetrised(kernel, square(1, 1, 1), 1.5), InvalidInput);
}

TEST(Kernel, OfAnUnknownNameListsThoseThereAre) {
  try {
    (void)kernel_family("squared_exponental");
    FAIL();
  } catch (const InvalidInput& e) {
    EXPECT_NE(std::string(e.what()).find("squared_exponential"), std::string::npos);
  }
}

}  // namespace
}  // namespace chladni::priors
