#include "priors/learned_corrections.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "base/error.h"

namespace chladni::priors {
namespace {

class Random {
 public:
  explicit Random(unsigned seed) : random_(seed) {}
  double uniform() { return (static_cast<double>(random_()) + 0.5) / 4294967296.0; }
  double normal() {
    const double length = std::sqrt(-2.0 * std::log(uniform()));
    return length * std::cos(2.0 * std::numbers::pi * uniform());
  }
  Eigen::MatrixXd normal(Eigen::Index rows, Eigen::Index cols) {
    Eigen::MatrixXd values(rows, cols);
    for (double& value : values.reshaped()) value = normal();
    return values;
  }

 private:
  std::mt19937 random_;
};

constexpr Eigen::Index kModes = 12;  // three of them rigid
constexpr Eigen::Index kPlaces = 10;
constexpr Eigen::Index kShapes = 6;

// A made-up simulation, modes 5 and 6 repeated; three masses and two fields that may be wrong.
struct Made {
  ModalBasis basis;
  Eigen::MatrixXd shapes;  // at the places
  std::vector<Correction> corrections;
};

Made made(unsigned seed) {
  Random random(seed);
  Made all;
  all.basis.frequency_hz.resize(kModes);
  all.basis.frequency_hz << 0, 0, 0, 100, 140, 140, 210, 260, 300, 390, 450, 520;
  const Eigen::MatrixXd surface = random.normal(60, kModes);
  all.basis.gram = surface.transpose() * surface / 60.0;
  all.basis.beyond_hz = Eigen::VectorXd::LinSpaced(20, 560, 2000);
  all.basis.beyond_square = 1.0;
  all.shapes = random.normal(kPlaces, kModes);
  for (int k = 0; k < 3; ++k) {
    const Eigen::RowVectorXd place = random.normal(1, kModes);
    all.corrections.push_back({"mass " + std::to_string(k), {}, place.transpose() * place, 0.03});
  }
  const Eigen::VectorXd lambda = (2.0 * std::numbers::pi * all.basis.frequency_hz).cwiseAbs2();
  for (int k = 0; k < 2; ++k) {
    const Eigen::MatrixXd any = random.normal(kModes, kModes) / std::sqrt(kModes);
    const Eigen::MatrixXd field =
        lambda.cwiseSqrt().asDiagonal() * (any + any.transpose()) * lambda.cwiseSqrt().asDiagonal();
    all.corrections.push_back({"field " + std::to_string(k), field, {}, 0.05});
  }
  all.corrections.push_back(
      {"both", all.corrections.back().stiffness, all.corrections.front().mass, 0.03});
  return all;
}

// What a test of the corrected simulation brings.
MeasuredShapes measured_of(const Made& all, const Eigen::VectorXd& parameters, double noise,
                           unsigned seed) {
  const auto modes = corrected_modes(all.basis.frequency_hz, all.corrections, parameters).value();
  MeasuredShapes measured;
  measured.places.shapes = all.shapes;
  measured.places.position.setZero(kPlaces, 3);
  measured.frequency_hz = modes.frequency_hz.segment(3, kShapes);
  measured.values = all.shapes * modes.turn.middleCols(3, kShapes);
  measured.values += noise * Random(seed).normal(kPlaces, kShapes);
  measured.noise = Eigen::MatrixXd::Constant(kPlaces, kShapes, noise);
  return measured;
}

Eigen::VectorXd correction_parameters() {
  return (Eigen::VectorXd(6) << 0.03, 0.02, -0.01, 0.04, -0.05, 0.02).finished();
}

const ResidualErrors kErrors{{0.05, 2.0, 0.9}, 1.1};

TEST(CorrectedModes, DiagonaliseTheCorrectedStiffnessAndMass) {
  const auto all = made(1);
  const auto parameters = correction_parameters();
  const auto modes = corrected_modes(all.basis.frequency_hz, all.corrections, parameters).value();
  Eigen::MatrixXd stiffness =
      (2.0 * std::numbers::pi * all.basis.frequency_hz).cwiseAbs2().asDiagonal();
  Eigen::MatrixXd mass = Eigen::MatrixXd::Identity(kModes, kModes);
  for (std::size_t f = 0; f < all.corrections.size(); ++f) {
    const double value = parameters(static_cast<Eigen::Index>(f));
    if (all.corrections[f].stiffness.size() > 0) stiffness += value * all.corrections[f].stiffness;
    if (all.corrections[f].mass.size() > 0) mass += value * all.corrections[f].mass;
  }
  const Eigen::MatrixXd& turn = modes.turn;
  EXPECT_TRUE((turn.transpose() * mass * turn).isIdentity(1e-12));
  const Eigen::MatrixXd lambda =
      (2.0 * std::numbers::pi * modes.frequency_hz).cwiseAbs2().asDiagonal();
  EXPECT_LT((turn.transpose() * stiffness * turn - lambda).norm(), 1e-11 * lambda.norm());
  EXPECT_TRUE((modes.frequency_hz.head<3>().array() == 0.0).all());
  EXPECT_GT(modes.frequency_hz(3), 0.0);
}

TEST(CorrectedModes, AreNoneWhereAMassIsNegative) {
  const auto all = made(1);
  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(6);
  parameters(0) = -10.0;
  EXPECT_FALSE(corrected_modes(all.basis.frequency_hz, all.corrections, parameters).has_value());
}

TEST(CorrectedEvidence, IsThePooledOneWithoutCorrections) {
  const auto all = made(1);
  const auto measured = measured_of(all, correction_parameters(), 0.02, 3);
  const auto plain = pooled_evidence(measured, all.basis, kErrors);
  const auto none = corrected_evidence(measured, all.basis, {}, kErrors, {}).value();
  const auto zero =
      corrected_evidence(measured, all.basis, all.corrections, kErrors, Eigen::VectorXd::Zero(6))
          .value();
  for (const auto& found : {none, zero}) {
    EXPECT_NEAR(found.log_evidence, plain.log_evidence, 1e-9);
    EXPECT_LT((found.slopes.head<4>() - plain.slopes).norm(), 1e-8 * plain.slopes.norm());
  }
}

// Slopes against central differences; at 0 the modes 5 and 6 are repeated.
void expect_slopes_equal_differences(const Made& all, const MeasuredShapes& measured,
                                     const Eigen::VectorXd& parameters) {
  const auto found =
      corrected_evidence(measured, all.basis, all.corrections, kErrors, parameters).value();
  const auto evidence = [&](const Eigen::VectorXd& at) {
    return corrected_evidence(measured, all.basis, all.corrections, kErrors, at)->log_evidence;
  };
  for (Eigen::Index f = 0; f < parameters.size(); ++f) {
    const double step = 1e-6;
    Eigen::VectorXd up = parameters;
    Eigen::VectorXd down = parameters;
    up(f) += step;
    down(f) -= step;
    const double difference = (evidence(up) - evidence(down)) / (2.0 * step);
    EXPECT_NEAR(found.slopes(4 + f), difference, 1e-5 * found.slopes.tail(6).norm())
        << all.corrections[static_cast<std::size_t>(f)].name;
  }
}

TEST(CorrectedEvidence, SlopesEqualDifferences) {
  const auto all = made(1);
  const auto measured = measured_of(all, correction_parameters(), 0.02, 3);
  expect_slopes_equal_differences(all, measured, 0.5 * correction_parameters());
  expect_slopes_equal_differences(all, measured, Eigen::VectorXd::Zero(6));
}

TEST(CorrectedEvidence, SlopesEqualDifferencesForAMotionAsAWhole) {
  const auto all = made(1);
  auto measured = measured_of(all, correction_parameters(), 0.02, 3);
  measured.frequency_hz(0) = 0.0;
  expect_slopes_equal_differences(all, measured, 0.5 * correction_parameters());
}

TEST(CorrectedEvidence, SlopesEqualDifferencesForAShapeAtRestOfAHeldBody) {
  auto all = made(1);
  all.basis.frequency_hz.head(3) << 20, 35, 60;
  auto measured = measured_of(all, correction_parameters(), 0.02, 3);
  measured.frequency_hz(0) = 0.0;
  expect_slopes_equal_differences(all, measured, 0.5 * correction_parameters());
}

// The same simulation with its modes chosen, ordered and signed in another way.
Made told_otherwise(const Made& all, const Eigen::MatrixXd& turn) {
  auto other = all;
  const Eigen::MatrixXd lambda =
      (2.0 * std::numbers::pi * all.basis.frequency_hz).cwiseAbs2().asDiagonal();
  const Eigen::VectorXd turned = (turn.transpose() * lambda * turn).diagonal();
  other.basis.frequency_hz = turned.cwiseSqrt() / (2.0 * std::numbers::pi);
  other.basis.gram = turn.transpose() * all.basis.gram * turn;
  other.shapes = all.shapes * turn;
  for (auto& one : other.corrections) {
    if (one.stiffness.size() > 0) one.stiffness = turn.transpose() * one.stiffness * turn;
    if (one.mass.size() > 0) one.mass = turn.transpose() * one.mass * turn;
  }
  return other;
}

void expect_same_evidence(const Made& all, const Eigen::MatrixXd& turn) {
  const auto other = told_otherwise(all, turn);
  const auto measured = measured_of(all, correction_parameters(), 0.02, 3);
  auto same = measured;
  same.places.shapes = other.shapes;
  const Eigen::VectorXd at = 0.7 * correction_parameters();
  const auto one = corrected_evidence(measured, all.basis, all.corrections, kErrors, at).value();
  const auto two = corrected_evidence(same, other.basis, other.corrections, kErrors, at).value();
  EXPECT_NEAR(one.log_evidence, two.log_evidence, 1e-8 * std::abs(one.log_evidence));
  EXPECT_LT((one.slopes - two.slopes).norm(), 1e-7 * one.slopes.norm());
}

TEST(CorrectedEvidence, IsBlindToARotationOfRepeatedModes) {
  Eigen::MatrixXd turn = Eigen::MatrixXd::Identity(kModes, kModes);
  turn.block<2, 2>(4, 4) << 0.6, -0.8, 0.8, 0.6;
  expect_same_evidence(made(1), turn);
}

TEST(CorrectedEvidence, IsBlindToOrderAndSignOfTheModes) {
  Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(kModes, kModes);
  for (Eigen::Index j = 0; j < kModes; ++j) turn((5 * j + 2) % kModes, j) = j % 3 == 0 ? -1.0 : 1.0;
  expect_same_evidence(made(1), turn);
}

TEST(LearnedCorrections, FindATruthThatIsACorrectedSimulation) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const auto all = made(seed);
    Random random(seed + 10);
    Eigen::VectorXd truth(6);
    for (Eigen::Index f = 0; f < 6; ++f) {
      truth(f) = all.corrections[static_cast<std::size_t>(f)].deviation * random.normal();
    }
    truth.head<3>() = truth.head<3>().cwiseAbs();
    const auto measured = measured_of(all, truth, 0.005, seed);
    const auto learned =
        learned_corrections(measured, all.basis, all.corrections, {.middle = {0.1, 5.0, 1.0, 1.0}});
    const Eigen::ArrayXd away = (learned.parameters - truth).array() / learned.deviation.array();
    EXPECT_LT(away.square().mean(), 4.0) << "seed " << seed << ": " << away.transpose();
    EXPECT_LT(away.abs().maxCoeff(), 4.0) << "seed " << seed;
    for (Eigen::Index f = 0; f < 6; ++f) {
      EXPECT_LT(learned.deviation(f), all.corrections[static_cast<std::size_t>(f)].deviation);
    }
  }
}

TEST(LearnedCorrections, StayAtNoneWhereTheSimulationIsRight) {
  const auto all = made(1);
  const auto measured = measured_of(all, Eigen::VectorXd::Zero(6), 0.005, 1);
  const auto learned =
      learned_corrections(measured, all.basis, all.corrections, {.middle = {0.1, 5.0, 1.0, 1.0}});
  EXPECT_LT((learned.parameters.array() / learned.deviation.array()).abs().maxCoeff(), 3.0);
  EXPECT_TRUE(learned.doubts.empty());
  EXPECT_TRUE(learned.correction_doubts.empty());
}

TEST(LearnedCorrections, SayWhatIsFarFromPlausible) {
  auto all = made(1);
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(6);
  truth(1) = 0.03;
  const auto measured = measured_of(all, truth, 0.002, 1);
  for (auto& one : all.corrections) one.deviation = 0.003;
  const auto learned =
      learned_corrections(measured, all.basis, all.corrections, {.middle = {0.1, 5.0, 1.0, 1.0}});
  EXPECT_TRUE(learned.doubts.empty());  // what is left is plausible
  ASSERT_FALSE(learned.correction_doubts.empty());
  const auto& first = learned.correction_doubts.front();
  EXPECT_NE(first.find("mass 1"), std::string::npos) << first;
}

// The stated noise is ten times the real one: the doubt is that of the noise, not of a correction.
TEST(LearnedCorrections, SayThatTheNoiseIsNotTheStatedOne) {
  const auto all = made(1);
  auto measured = measured_of(all, Eigen::VectorXd::Zero(6), 0.005, 1);
  const ResidualPlausible plausible{.middle = {0.1, 5.0, 1.0, 1.0}};
  const auto fair = learned_corrections(measured, all.basis, all.corrections, plausible);
  EXPECT_TRUE(fair.doubts.empty());
  measured.noise *= 10.0;
  const auto learned = learned_corrections(measured, all.basis, all.corrections, plausible);
  ASSERT_FALSE(learned.doubts.empty());
  EXPECT_TRUE(learned.doubts.front().starts_with("the noise over the stated one is"))
      << learned.doubts.front();
  EXPECT_TRUE(learned.correction_doubts.empty());
}

// A real structure of four times the stiffness per mass is no correction's either.
TEST(LearnedCorrections, SayThatTheStiffnessAsAWholeIsFarOff) {
  const auto all = made(1);
  auto measured = measured_of(all, Eigen::VectorXd::Zero(6), 0.005, 1);
  measured.frequency_hz *= 2.2;
  const auto learned =
      learned_corrections(measured, all.basis, all.corrections, {.middle = {0.1, 5.0, 1.0, 1.0}});
  const auto is_gamma = [](const std::string& doubt) { return doubt.starts_with("gamma"); };
  EXPECT_TRUE(std::ranges::any_of(learned.doubts, is_gamma)) << learned.doubts.size();
}

TEST(LearnedCorrections, RefuseWhatDoesNotFit) {
  auto all = made(1);
  const auto measured = measured_of(all, Eigen::VectorXd::Zero(6), 0.005, 1);
  all.corrections[0].deviation = 0.0;
  EXPECT_THROW((void)learned_corrections(measured, all.basis, all.corrections), InvalidInput);
  all.corrections[0] = {"small", {}, Eigen::MatrixXd::Identity(3, 3), 1.0};
  EXPECT_THROW((void)learned_corrections(measured, all.basis, all.corrections), InvalidInput);
}

}  // namespace
}  // namespace chladni::priors
