#include "modal/control_model.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/modal/chain.h"
#include "tests/refusal.h"

namespace chladni::modal {
namespace {

const std::vector<OutputChannel> kThree{{"s1"}, {"s2"}, {"s3"}};
const std::vector<std::string> kTwo{"a1", "a2"};

ReducedModel two_sided(bool held) { return reduced(chain(20, held), 8, {0, 7, 19}, {2, 19}, 0.01); }

ControlModel delayed() {
  auto model = control_model(two_sided(false), kThree, kTwo);
  model.input_delay << 0.35e-3, 0.0;
  model.output_delay << 0.0, 0.2e-3, 0.17e-3;
  return model;
}

// The largest difference of responses over frequencies, relative to the response there.
double difference(const ControlModel& one, const ControlModel& other, double up_to_hz) {
  double largest = 0.0;
  for (const double f : Eigen::VectorXd::LinSpaced(40, 0.01 * up_to_hz, up_to_hz)) {
    const auto expected = response(other, f);
    largest = std::max(largest, (response(one, f) - expected).norm() / expected.norm());
  }
  return largest;
}

TEST(ControlModel, RespondsAsTheModesDoLaterByTheDelays) {
  const auto model = delayed();
  const Eigen::VectorXd frequency_hz = Eigen::VectorXd::LinSpaced(60, 3.0, 4000.0);
  const auto modes = frf(two_sided(false), frequency_hz);
  for (Eigen::Index k = 0; k < 60; ++k) {
    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * frequency_hz(k));
    Eigen::MatrixXcd expected = modes.value[static_cast<std::size_t>(k)];
    expected.col(0) *= std::exp(-s * 0.35e-3);
    expected.row(1) *= std::exp(-s * 0.2e-3);
    expected.row(2) *= std::exp(-s * 0.17e-3);
    EXPECT_LT((response(model, frequency_hz(k)) - expected).norm(), 1e-10 * expected.norm());
  }
}

TEST(ControlModel, GivesEachOutputInItsOwnQuantity) {
  auto modes = two_sided(true);
  modes.residual.setZero();  // has no place in a proper model of velocities
  const auto model =
      control_model(modes, {{"s1"}, {"s2", FrfKind::mobility}, {"s3", FrfKind::accelerance}}, kTwo);
  EXPECT_EQ(model.outputs[0].unit + " " + model.outputs[1].unit + " " + model.outputs[2].unit,
            "m m/s m/s^2");
  for (const double f : {10.0, 300.0, 2000.0}) {
    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * f);
    Eigen::MatrixXcd expected = frf(modes, Eigen::VectorXd::Constant(1, f)).value[0];
    expected.row(1) *= s;
    expected.row(2) *= s * s;
    const auto found = response(model, f);
    for (Eigen::Index i = 0; i < 3; ++i) {
      EXPECT_LT((found.row(i) - expected.row(i)).norm(), 1e-9 * expected.row(i).norm());
    }
  }
}

// Dashpots beside residual flexibility: the modes' part of velocity and acceleration is
// Φ q̇ and Φ q̈ with q from the structure's equations, (s² + 2ζωs + ω²) q = R u + Φ_dᵀ f and
// (1 + s R_dd) f = −s (Φ_d q + R_du u).
TEST(ControlModel, GivesVelocityAndAccelerationBesideDashpots) {
  auto structure = chain(20, true);
  structure.dashpots = Eigen::MatrixXd::Zero(20, 2);
  structure.dashpots(3, 0) = std::sqrt(40.0);
  structure.dashpots(7, 1) = std::sqrt(300.0);
  structure.dashpots(12, 1) = -std::sqrt(300.0);
  const auto modes = reduced(structure, 8, {0, 7, 19}, {2, 19}, 0.01);
  const auto model =
      control_model(modes, {{"s1"}, {"s2", FrfKind::mobility}, {"s3", FrfKind::accelerance}}, kTwo);
  const auto n = modes.mode_count();
  for (const double f : {5.0, 60.0, 400.0, 1500.0}) {
    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * f);
    Eigen::MatrixXcd pencil = Eigen::MatrixXcd::Zero(n + 2, n + 2);
    for (Eigen::Index m = 0; m < n; ++m) {
      const double w = 2.0 * std::numbers::pi * modes.frequency_hz(m);
      pencil(m, m) = s * s + 2.0 * modes.damping_ratio(m) * w * s + w * w;
    }
    pencil.topRightCorner(n, 2) = -modes.dampers.shapes.transpose();
    pencil.bottomLeftCorner(2, n) = s * modes.dampers.shapes;
    pencil.bottomRightCorner(2, 2) = s * modes.dampers.among;
    pencil.bottomRightCorner(2, 2).diagonal().array() += 1.0;
    Eigen::MatrixXcd right(n + 2, 2);
    right << modes.input_shapes, -s * modes.dampers.from_inputs;
    const Eigen::MatrixXcd q = pencil.partialPivLu().solve(right).topRows(n);
    const Eigen::MatrixXcd expected = modes.output_shapes * q;
    const auto found = response(model, f);
    EXPECT_LT((found.row(1) - s * expected.row(1)).norm(), 1e-9 * (s * expected.row(1)).norm());
    EXPECT_LT((found.row(2) - s * s * expected.row(2)).norm(),
              1e-9 * (s * s * expected.row(2)).norm())
        << f;
    const auto whole = frf(modes, Eigen::VectorXd::Constant(1, f)).value[0];
    EXPECT_LT((found.row(0) - whole.row(0)).norm(), 1e-9 * whole.row(0).norm());
  }
}

TEST(ControlModel, KeepsModesApartAlsoInSamples) {
  const auto model = control_model(two_sided(false), kThree, kTwo);
  const auto sampled = discretised(model, 1e-4);
  for (const auto& a : {model.space.a, sampled.space.a}) {
    auto rest = a;
    for (Eigen::Index m = 0; m < 8; ++m) rest.block<2, 2>(2 * m, 2 * m).setZero();
    EXPECT_EQ(rest.cwiseAbs().maxCoeff(), 0.0);
  }
  EXPECT_EQ(model.states[0].name, "mode_1_position");
  EXPECT_EQ(model.states[3].name, "mode_2_velocity");
}

// The exact step of one mode: with σ = −ζω and ω_d, over one sample T,
// x₁ = ωq, x₂ = q̇ of q̈ + 2ζω q̇ + ω² q = u.
TEST(ControlModel, HasTheClosedFormOfOneMode) {
  ReducedModel one;
  one.frequency_hz = Eigen::VectorXd::Constant(1, 120.0);
  one.damping_ratio = Eigen::VectorXd::Constant(1, 0.003);
  one.output_shapes = Eigen::MatrixXd::Constant(1, 1, 0.7);
  one.input_shapes = Eigen::MatrixXd::Constant(1, 1, -0.4);
  one.residual = Eigen::MatrixXd::Constant(1, 1, 1e-8);
  const double w = 2.0 * std::numbers::pi * 120.0;
  const double z = 0.003;
  const double turned = w * std::sqrt(1.0 - z * z);
  for (const double t : {1e-5, 1e-3, 0.02}) {  // the last is longer than two periods
    const auto sampled = discretised(control_model(one, {{"s"}}, {"a"}), t).space;
    const double decay = std::exp(-z * w * t);
    const double cosine = decay * std::cos(turned * t);
    const double sine = decay * std::sin(turned * t) * w / turned;
    Eigen::Matrix2d a;
    a << cosine + z * sine, sine, -sine, cosine - z * sine;
    const Eigen::Vector2d b = -0.4 / w * Eigen::Vector2d(1.0 - cosine - z * sine, sine);
    EXPECT_LT((sampled.a - a).norm(), 1e-12);
    EXPECT_LT((sampled.b - b).norm(), 1e-11 * b.norm());
    EXPECT_EQ(sampled.d(0, 0), 1e-8);
  }
}

// Outputs at every `every`-th of `count` steps of a discrete model; u(k) is the input at step k.
template <typename Input>
Eigen::MatrixXd outputs_of(const StateSpace& model, Eigen::Index count, const Input& u) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(model.a.rows());
  Eigen::MatrixXd y(model.c.rows(), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    y.col(k) = model.c * x + model.d * u(k);
    x = model.a * x + model.b * u(k);
  }
  return y;
}

// A sample in twenty parts of which all delays are multiples: each part is sampled without a delay,
// which is passed by shifting inputs and outputs.
TEST(ControlModel, SampledWithAnyDelaysIsWhatAFinerClockSees) {
  constexpr Eigen::Index kParts = 20;
  constexpr Eigen::Index kSamples = 60;
  const double sample = 2e-4;
  auto model = control_model(two_sided(false), kThree, kTwo);
  const Eigen::Vector2<Eigen::Index> input_parts(47, 5);
  const Eigen::Vector3<Eigen::Index> output_parts(0, 33, 16);
  model.input_delay = input_parts.cast<double>() * sample / kParts;
  model.output_delay = output_parts.cast<double>() * sample / kParts;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd u =
      Eigen::MatrixXd::NullaryExpr(2, kSamples, [&] { return normal(random); });
  const auto fine = discretised(model.space, sample / kParts);
  const auto seen = outputs_of(fine, kParts * kSamples, [&](Eigen::Index k) {
    Eigen::Vector2d now = Eigen::Vector2d::Zero();
    for (Eigen::Index j = 0; j < 2; ++j) {
      if (k >= input_parts(j)) now(j) = u(j, (k - input_parts(j)) / kParts);
    }
    return now;
  });
  const auto coarse = with_delay_states(discretised(model, sample)).space;
  const auto found = outputs_of(coarse, kSamples, [&](Eigen::Index k) { return u.col(k); });
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index k = 0; k < kSamples; ++k) {
      const auto part = k * kParts - output_parts(i);
      const double expected = part < 0 ? 0.0 : seen(i, part);
      EXPECT_NEAR(found(i, k), expected, 1e-10 * seen.row(i).cwiseAbs().maxCoeff())
          << i << " " << k;
    }
  }
}

TEST(ControlModel, DelayStatesChangeNoResponse) {
  const auto sampled = discretised(delayed(), 1e-4);
  EXPECT_EQ(sampled.input_delay(0), 3.0);
  EXPECT_EQ(sampled.output_delay(1), 2.0);
  EXPECT_EQ(sampled.output_delay(2), 2.0);  // 1.7 samples: two, and the output 0.3 after the clock
  const auto states = with_delay_states(sampled);
  EXPECT_EQ(states.space.a.rows(), sampled.space.a.rows() + 7);
  EXPECT_EQ(states.states.size(), static_cast<std::size_t>(states.space.a.rows()));
  EXPECT_LT(difference(states, sampled, 4000.0), 1e-11);
}

TEST(ControlModel, SampledRespondsAsTheHoldDoesInFrequency) {
  // Aliases of a fast clock are small: G times the hold is what is left.
  auto model = control_model(two_sided(true), kThree, kTwo);
  model.space.d.setZero();
  model.input_delay << 3.3e-6, 0.0;
  const double sample = 2e-6;
  const auto sampled = discretised(model, sample);
  for (const double f : {20.0, 350.0, 900.0}) {
    const double half = std::numbers::pi * f * sample;
    const auto hold = std::exp(std::complex<double>(0.0, -half)) * std::sin(half) / half;
    const Eigen::MatrixXcd expected = hold * response(model, f);
    EXPECT_LT((response(sampled, f) - expected).norm(), 1e-4 * expected.norm()) << f;
  }
}

ControlModel pure_delay(double seconds) {
  StateSpace unit{Eigen::MatrixXd(0, 0), Eigen::MatrixXd(0, 1), Eigen::MatrixXd(1, 0),
                  Eigen::MatrixXd::Ones(1, 1), 0.0};
  auto model = control_model(unit, {}, {{"y"}}, {"u"});
  model.input_delay << seconds;
  return model;
}

// Delays of an input and an output that are whole samples together pass a step at that sample. By
// rounding of their sum it came a sample later.
TEST(ControlModel, DelaysOfBothSidesThatAreAWholeSamplePassAStepThen) {
  constexpr double kSample = 1e-3;
  for (int parts = 1; parts < 25; ++parts) {
    auto model = pure_delay(4e-5 * parts);
    model.output_delay << 4e-5 * (25 - parts);
    const auto sampled = with_delay_states(discretised(model, kSample)).space;
    const auto y = outputs_of(sampled, 4, [](Eigen::Index) { return Eigen::VectorXd::Ones(1); });
    EXPECT_EQ(y, (Eigen::RowVector4d(0.0, 1.0, 1.0, 1.0))) << parts;
  }
}

TEST(ControlModel, PadeOfFirstAndSecondOrderAreThoseOfTheTextbook) {
  const double tau = 1e-3;
  for (const double f : {10.0, 200.0, 1500.0}) {
    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * f * tau);
    const auto first = response(with_pade_delays(pure_delay(tau), 1), f)(0, 0);
    EXPECT_LT(std::abs(first - (2.0 - s) / (2.0 + s)), 1e-13);
    const auto second = response(with_pade_delays(pure_delay(tau), 2), f)(0, 0);
    EXPECT_LT(std::abs(second - (12.0 - 6.0 * s + s * s) / (12.0 + 6.0 * s + s * s)), 1e-13);
  }
}

TEST(ControlModel, PadePassesAllFrequenciesAndIsRightBelowItsLimit) {
  const double tau = 0.8e-3;
  const double degree = std::numbers::pi / 180.0;
  for (int order = 1; order <= kHighestPade; ++order) {
    const auto pade = with_pade_delays(pure_delay(tau), order);
    EXPECT_LT(pade.space.a.eigenvalues().real().maxCoeff(), 0.0);
    for (const double f : {1.0, 100.0, 1e4}) {
      EXPECT_NEAR(std::abs(response(pade, f)(0, 0)), 1.0, 1e-12) << order;
    }
    const double limit = pade_limit_hz(pure_delay(tau), order, degree);
    const auto turned = [&](double f) {
      return std::abs(
          std::arg(response(pade, f)(0, 0) *
                   std::exp(std::complex<double>(0.0, 2.0 * std::numbers::pi * f * tau))));
    };
    EXPECT_LT(turned(limit), 1.05 * degree) << order;
    EXPECT_GT(turned(1.5 * limit), degree) << order;
  }
}

TEST(ControlModel, PadeOfChannelsIsNearTheirDelays) {
  const auto pade = with_pade_delays(delayed(), 8);
  EXPECT_EQ(pade.space.a.rows(), 16 + 3 * 8);
  EXPECT_EQ(pade.input_delay.norm() + pade.output_delay.norm(), 0.0);
  EXPECT_LT(difference(pade, delayed(), 2000.0), 1e-6);
}

TEST(ControlModel, RefusesWhatCannotBeMeant) {
  auto model = delayed();
  EXPECT_NE(refusal_of([&] { return discretised(model, -1e-3); }).find("sample time"),
            std::string::npos);
  EXPECT_NE(refusal_of([&] { return discretised(model, std::nan("")); }).find("sample time"),
            std::string::npos);
  model.input_delay(0) = 3.0;
  EXPECT_EQ(
      refusal_of([&] { return discretised(model, 1e-4); }),
      "control model: the delay of input \"a1\" is 3 s, 30000 samples at 10000 Hz; expected at "
      "most 4096 samples");
  model.input_delay(0) = -1e-6;
  EXPECT_NE(refusal_of([&] { return response(model, 10.0); }).find("expected 0 or more"),
            std::string::npos);
  model.input_delay(0) = 0.0;
  EXPECT_NE(refusal_of([&] { return with_pade_delays(model, 11); }).find("expected 1 to 10"),
            std::string::npos);
  EXPECT_NE(refusal_of([&] { return with_delay_states(model); }).find("discrete"),
            std::string::npos);
  EXPECT_NE(
      refusal_of([&] { return control_model(two_sided(true), {{"s1"}}, kTwo); }).find("names"),
      std::string::npos);
}

TEST(ControlModel, RefusesMoreDelayThanFitsIntoMemory) {
  auto sampled = discretised(control_model(two_sided(false), kThree, kTwo), 1e-4);
  sampled.input_delay << 4000.0, 0.0;
  sampled.output_delay << 81.0, 0.0, 0.0;
  EXPECT_EQ(refusal_of([&] { return with_delay_states(sampled); }),
            "control model: with its delays as states the model has 4097 states; expected at most "
            "4096");
  sampled.input_delay << 4097.0, 0.0;
  EXPECT_NO_THROW(check(sampled));
  sampled.input_delay << 4098.0, 0.0;
  EXPECT_NE(refusal_of([&] { return response(sampled, 1.0); }).find("expected 0 to 4097 samples"),
            std::string::npos);
}

TEST(ControlModel, PolesOfDashpotsAreNoModes) {
  auto structure = chain(20, false);
  structure.dashpots = Eigen::MatrixXd::Zero(20, 1);
  structure.dashpots(3, 0) = 1e-3;  // a lag of far below the periods
  const auto modes = reduced(structure, 8, {0, 7, 19}, {2, 19}, 0.01);
  const auto found = poles(control_model(modes, kThree, kTwo));
  EXPECT_GT(found.value.cwiseAbs().maxCoeff(), 1e6 * 2.0 * std::numbers::pi * found.highest_hz());
  EXPECT_NEAR(found.highest_hz(), modes.frequency_hz(7), 1e-6 * modes.frequency_hz(7));
  Eigen::Index integrators = 0;
  for (const auto& pole : found.value) {
    if (found.is_integrator(pole)) ++integrators;
    EXPECT_NE(found.is_integrator(pole), found.is_damped(pole));
    EXPECT_FALSE(found.is_unstable(pole));
  }
  EXPECT_EQ(integrators, 2);
}

TEST(ControlModel, WithoutStatesHasNoPoles) {
  StateSpace still;
  still.a.resize(0, 0);
  still.b.resize(0, 2);
  still.c.resize(3, 0);
  still.d = Eigen::MatrixXd::Ones(3, 2);
  const auto model = control_model(still, {}, kThree, kTwo);
  EXPECT_EQ(poles(model).value.size(), 0);
  EXPECT_EQ(poles(model).highest_hz(), 0.0);
  EXPECT_EQ(reduced(model, 0).hankel.size(), 0);
}

TEST(ControlModel, AnExplosionWithinASampleIsAFailureNotANumber) {
  auto model = control_model(two_sided(true), kThree, kTwo);
  model.space.a *= -1e6;
  EXPECT_THROW((void)discretised(model, 1.0), NumericalFailure);
}

}  // namespace
}  // namespace chladni::modal
