#include "modal/frf.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/error.h"
#include "tests/modal/chain.h"

namespace chladni::modal {
namespace {

using Complex = std::complex<double>;

// m = 2 kg, ω0 = 2π 50 Hz, ζ = 1 %.
ReducedModel oscillator() {
  ReducedModel model;
  model.frequency_hz = Eigen::VectorXd::Constant(1, 50.0);
  model.damping_ratio = Eigen::VectorXd::Constant(1, 0.01);
  model.output_shapes = Eigen::MatrixXd::Constant(1, 1, 1.0 / std::sqrt(2.0));
  model.input_shapes = model.output_shapes;
  model.residual = Eigen::MatrixXd::Zero(1, 1);
  return model;
}

Eigen::VectorXd lines(double from, double to, Eigen::Index count) {
  return Eigen::VectorXd::LinSpaced(count, from, to);
}

TEST(Frf, OfOneOscillatorIsTheClosedForm) {
  const auto found = frf(oscillator(), lines(0.0, 120.0, 241));
  const double own = 2.0 * std::numbers::pi * 50.0;
  for (Eigen::Index k = 0; k < 241; ++k) {
    const double omega = 2.0 * std::numbers::pi * found.frequency_hz(k);
    const Complex expected = 1.0 / (2.0 * Complex(own * own - omega * omega, 0.02 * own * omega));
    const auto value = found.value[static_cast<std::size_t>(k)](0, 0);
    EXPECT_LT(std::abs(value - expected), 1e-13 * std::abs(expected));
  }
}

TEST(Frf, HystereticLossIsThatOfALossFactorTwiceTheRatio) {
  const auto found =
      frf(oscillator(), lines(10.0, 120.0, 23), FrfKind::receptance, ModalDamping::hysteretic);
  const double stiffness = 2.0 * std::pow(2.0 * std::numbers::pi * 50.0, 2);
  for (Eigen::Index k = 0; k < 23; ++k) {
    const double omega = 2.0 * std::numbers::pi * found.frequency_hz(k);
    const Complex expected = 1.0 / (stiffness * Complex(1.0, 0.02) - 2.0 * omega * omega);
    const auto value = found.value[static_cast<std::size_t>(k)](0, 0);
    EXPECT_LT(std::abs(value - expected), 1e-13 * std::abs(expected));
  }
}

TEST(Frf, OfADashpotOnAnOscillatorIsModalDampingOfTheSameSize) {
  auto model = oscillator();
  const auto modal = frf(model, lines(1.0, 100.0, 34));
  model.damping_ratio(0) = 0.0;
  const double c = 2.0 * 0.01 * 2.0 * (2.0 * std::numbers::pi * 50.0);  // 2 ζ m ω
  model.dampers.shapes = std::sqrt(c) * model.output_shapes;
  model.dampers.to_outputs = model.dampers.from_inputs = model.dampers.among =
      Eigen::MatrixXd::Zero(1, 1);
  auto local = frf(model, lines(1.0, 100.0, 34));
  for (std::size_t k = 0; k < 34; ++k) {
    EXPECT_LT((local.value[k] - modal.value[k]).norm(), 1e-12 * modal.value[k].norm());
  }
}

TEST(Frf, OfAllModesIsTheDirectSolution) {
  const std::vector<Eigen::Index> outputs{0, 5, 11};
  const std::vector<Eigen::Index> inputs{2, 11};
  for (const bool held : {false, true}) {
    auto structure = chain(12, held);
    structure.dashpots = Eigen::MatrixXd::Zero(12, 2);
    structure.dashpots(3, 0) = std::sqrt(40.0);
    structure.dashpots(7, 1) = std::sqrt(200.0);
    structure.dashpots(9, 1) = -std::sqrt(200.0);
    const auto model = reduced(structure, 12, outputs, inputs, 0.0);
    for (const double f : {20.0, 300.0, 1111.0, 2950.0, 5000.0}) {
      const auto expected = direct(structure, Eigen::MatrixXd::Zero(12, 12), f, outputs, inputs);
      const auto found = frf(model, Eigen::VectorXd::Constant(1, f)).value[0];
      EXPECT_LT((found - expected).norm(), 1e-9 * expected.norm()) << f << " Hz";
    }
  }
}

// Ten modes of sixty, far below the first one left out (824 Hz).
TEST(Frf, StaticCorrectionMakesAFewModesEnough) {
  const std::vector<Eigen::Index> at{0, 17, 59};
  for (const bool held : {false, true}) {
    auto structure = chain(60, held);
    structure.dashpots = Eigen::MatrixXd::Zero(60, 1);
    structure.dashpots(30, 0) = std::sqrt(100.0);
    const auto model = reduced(structure, 10, at, at, 0.0);
    auto truncated = model;
    truncated.residual.setZero();
    const double f = 1.0;
    const auto expected = direct(structure, Eigen::MatrixXd::Zero(60, 60), f, at, at);
    const auto error = [&](const ReducedModel& of) {
      return (frf(of, Eigen::VectorXd::Constant(1, f)).value[0] - expected).norm();
    };
    EXPECT_LT(error(model), 1e-6 * expected.norm());
    EXPECT_LT(error(model), 1e-4 * error(truncated));
    EXPECT_GT(error(truncated), 0.1 * model.residual.norm());
  }
}

TEST(Frf, ErrorOfTheStaticCorrectionFallsWithTheSquareOfTheFrequency) {
  const auto structure = chain(60, true);
  const std::vector<Eigen::Index> at{0, 59};
  const auto model = reduced(structure, 10, at, at, 0.0);
  const auto error = [&](double f) {
    const auto expected = direct(structure, Eigen::MatrixXd::Zero(60, 60), f, at, at);
    return (frf(model, Eigen::VectorXd::Constant(1, f)).value[0] - expected).norm();
  };
  EXPECT_NEAR(error(40.0) / error(20.0), 4.0, 0.05);
}

TEST(Frf, IsReciprocal) {
  auto structure = chain(20, false);
  structure.dashpots = Eigen::MatrixXd::Constant(20, 1, 0.3);
  structure.dashpots(4, 0) = 9.0;
  const std::vector<Eigen::Index> at{1, 8, 19};
  const auto found = frf(reduced(structure, 6, at, at, 0.02), lines(5.0, 2000.0, 40));
  for (const auto& value : found.value) {
    EXPECT_LT((value - value.transpose()).norm(), 1e-12 * value.norm());
  }
}

TEST(Frf, CollocatedReceptanceLagsByHalfATurnAtMost) {
  const std::vector<Eigen::Index> at{3};
  for (const auto damping : {ModalDamping::viscous, ModalDamping::hysteretic}) {
    const auto found = frf(reduced(chain(20, true), 12, at, at, 0.01), lines(1.0, 6000.0, 2000),
                           FrfKind::receptance, damping);
    for (const auto& value : found.channel(0, 0)) {
      EXPECT_LE(std::arg(value), 0.0);
      EXPECT_GE(std::arg(value), -std::numbers::pi);
    }
  }
}

TEST(Frf, KindsDifferByOneDerivativeEach) {
  const std::vector<Eigen::Index> at{0, 3};
  const auto model = reduced(chain(6, false), 4, at, at, 0.01);
  const auto x = frf(model, lines(3.0, 900.0, 10));
  const auto v = frf(model, lines(3.0, 900.0, 10), FrfKind::mobility);
  const auto a = frf(model, lines(3.0, 900.0, 10), FrfKind::accelerance);
  for (std::size_t k = 0; k < 10; ++k) {
    const Complex s(0.0, 2.0 * std::numbers::pi * x.frequency_hz(static_cast<Eigen::Index>(k)));
    EXPECT_LT((v.value[k] - s * x.value[k]).norm(), 1e-14 * v.value[k].norm());
    EXPECT_LT((a.value[k] - s * s * x.value[k]).norm(), 1e-14 * a.value[k].norm());
    EXPECT_LT((converted(a, FrfKind::receptance).value[k] - x.value[k]).norm(),
              1e-14 * x.value[k].norm());
  }
}

TEST(Frf, OfAFreeBodyIsItsMassLineAtLowFrequencies) {
  const std::vector<Eigen::Index> at{0, 19};
  const auto a =
      frf(reduced(chain(20, false), 8, at, at, 0.0), lines(0.01, 0.02, 2), FrfKind::accelerance);
  EXPECT_TRUE(a.value[0].real().isApproxToConstant(1.0 / 2.0, 1e-6));  // 20 × 0.1 kg
}

TEST(Frf, ChannelIsOneEntryOverFrequency) {
  const std::vector<Eigen::Index> at{0, 3};
  const auto found = frf(reduced(chain(6, true), 4, at, at, 0.01), lines(3.0, 900.0, 5));
  const auto channel = found.channel(1, 0);
  ASSERT_EQ(channel.size(), 5);
  for (Eigen::Index k = 0; k < 5; ++k) {
    EXPECT_EQ(channel(k), found.value[static_cast<std::size_t>(k)](1, 0));
  }
}

TEST(Frf, RefusesWhatHasNoAnswer) {
  const std::vector<Eigen::Index> at{0};
  const auto free = reduced(chain(6, false), 4, at, at, 0.01);
  const auto at_line = [](double f) { return Eigen::VectorXd::Constant(1, f); };
  EXPECT_THROW((void)frf(free, at_line(0.0)), InvalidInput);
  EXPECT_THROW((void)frf(free, at_line(-1.0)), InvalidInput);
  EXPECT_THROW((void)frf(free, at_line(std::numeric_limits<double>::quiet_NaN())), InvalidInput);
  auto undamped = oscillator();
  undamped.damping_ratio(0) = 0.0;
  EXPECT_THROW((void)frf(undamped, at_line(50.0)), InvalidInput);
  auto bad = oscillator();
  bad.input_shapes.resize(2, 1);
  EXPECT_THROW((void)frf(bad, at_line(1.0)), InvalidInput);
  bad = oscillator();
  bad.residual(0, 0) = std::numeric_limits<double>::infinity();
  EXPECT_THROW((void)frf(bad, at_line(1.0)), InvalidInput);
  bad = oscillator();
  bad.rigid_count = 1;
  EXPECT_THROW((void)frf(bad, at_line(1.0)), InvalidInput);
  const auto at_rest = frf(oscillator(), at_line(0.0), FrfKind::accelerance);
  EXPECT_THROW((void)converted(at_rest, FrfKind::receptance), InvalidInput);
}

}  // namespace
}  // namespace chladni::modal
