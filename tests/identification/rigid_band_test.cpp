// The part of a predicted band that comes from the motion of the body as a whole.
#include "identification/field/rigid_band.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "identification/response_field.h"
#include "identification/spatio_temporal.h"
#include "simulators/portable_random.h"

namespace chladni::identification {
namespace {

// A free bar that moves as a rigid body.
struct FreeBar {
  Eigen::VectorXd sensors{{-0.4, -0.1, 0.2, 0.45}}, actuators{{-0.3, 0.05, 0.4}};
  Eigen::MatrixXd inverse_mass{{0.5, 0.1}, {0.1, 6.0}};

  static Eigen::MatrixXd directions(const Eigen::VectorXd& x) {
    Eigen::MatrixXd d = Eigen::MatrixXd::Ones(x.size(), 2);
    d.col(1) = x;
    return d;
  }
  [[nodiscard]] Eigen::MatrixXd products(const Eigen::VectorXd& x) const {
    return directions(x) * inverse_mass * directions(actuators).transpose();
  }
};

const Eigen::VectorXd kPlaces{{-0.5, 0.0, 0.3}};

// A fit's factors of noisy products, in a basis of its own.
ModalFit rigid_fit(const FreeBar& bar, double noise, simulators::Dice& dice) {
  const Eigen::MatrixXd turn{{3.0, 1.0}, {-2.0, 0.5}};
  ModalFit fit;
  fit.model.rigid_count = 2;
  fit.model.frequency_hz = fit.model.damping_ratio = Eigen::VectorXd::Zero(2);
  fit.model.output_shapes = FreeBar::directions(bar.sensors) * turn;
  fit.model.input_shapes =
      turn.inverse() * bar.inverse_mass * FreeBar::directions(bar.actuators).transpose();
  fit.model.residual = Eigen::MatrixXd::Zero(4, 3);
  fit.rigid_covariance = noise * noise * Eigen::MatrixXd::Identity(14, 14);
  const Eigen::VectorXd error = noise * Eigen::VectorXd(dice.normal(14, 1));
  fit.model.output_shapes += error.head(8).reshaped(4, 2);
  fit.model.input_shapes += error.tail(6).reshaped(2, 3);
  for (int m = 0; m < 2; ++m) {
    fit.mode_covariance.emplace_back(Eigen::MatrixXd::Zero(9, 9));
    fit.mode_covariance.back().bottomRightCorner(7, 7) =
        noise * noise * Eigen::MatrixXd::Identity(7, 7);
  }
  fit.frequency_std_hz = fit.damping_std = Eigen::VectorXd::Zero(2);
  fit.output_std = Eigen::MatrixXd::Constant(4, 2, noise);
  fit.input_std = Eigen::MatrixXd::Constant(2, 3, noise);
  fit.groups = {{0, 2}};
  return fit;
}

GainMatch matched_by_geometry(const FreeBar& bar, const ModalFit& fit) {
  std::vector<modal::MeasuredChannel> outputs(4);
  std::vector<modal::MeasuredChannel> inputs(3);
  for (std::size_t i = 0; i < 4; ++i) outputs[i].name = "y" + std::to_string(i + 1);
  for (std::size_t j = 0; j < 3; ++j) inputs[j].name = "u" + std::to_string(j + 1);
  GainMatchOptions options;
  options.geometry = RigidGeometry{
      FreeBar::directions(bar.sensors), FreeBar::directions(bar.actuators), {}, 0.0, false};
  return gain_match(fit, outputs, inputs, options);
}

PlacesOfInterest interest_of(const GainMatch& match) {
  const Eigen::MatrixXd directions = FreeBar::directions(kPlaces);
  return {directions * match.rigid->modes, rigid_deviation(*match.rigid, directions),
          Eigen::MatrixXd::Zero(3, 3)};
}

// Squared errors at unseen places over their stated variances have mean 1, whatever basis the fit
// has: of the 1/s² term, and of the rows.
TEST(RigidBand, IsAsWideAsErrorsAtUnseenPlaces) {
  const FreeBar bar;
  const Eigen::VectorXd line = Eigen::VectorXd::Constant(1, 10.0);
  const double square = std::pow(2.0 * std::numbers::pi * 10.0, 2);
  const Eigen::MatrixXd exact_modes = bar.inverse_mass.inverse().llt().matrixU().solve(
      Eigen::MatrixXd(Eigen::MatrixXd::Identity(2, 2)));
  const Eigen::MatrixXd exact_rows = FreeBar::directions(kPlaces) * exact_modes;
  simulators::Dice dice(11);
  double products = 0.0;
  double rows = 0.0;
  constexpr int kDraws = 300;
  for (int draw = 0; draw < kDraws; ++draw) {
    const auto fit = rigid_fit(bar, 0.01, dice);
    const auto match = matched_by_geometry(bar, fit);
    ASSERT_TRUE(match.rigid);
    const auto interest = interest_of(match);
    const auto found = predicted(fit, match, interest, line);
    const Eigen::ArrayXXd off = (found.value[0].real() * -square - bar.products(kPlaces)).array();
    products += (off / (square * found.deviation[0].array())).square().mean() / kDraws;
    const Eigen::ArrayXXd moved = (interest.shapes - exact_rows).array();
    rows += (moved / interest.deviation.array()).square().mean() / kDraws;
  }
  for (const double sum : {products, rows}) {
    EXPECT_GT(sum, 0.6);  // the misfit of a draw widens the band where it is above 1
    EXPECT_LT(sum, 1.2);
  }
}

// Without a body the rows of the places and of the actuators err each on its own.
TEST(RigidBand, WithoutABodyHasBothFactors) {
  const FreeBar bar;
  simulators::Dice dice(12);
  const auto fit = rigid_fit(bar, 0.01, dice);
  auto match = matched_by_geometry(bar, fit);
  auto interest = interest_of(match);
  interest.deviation.setZero();
  match.rigid.reset();
  const Eigen::MatrixXd of_inputs = rigid_variance(fit, match, interest);
  EXPECT_GT(of_inputs.minCoeff(), 0.0);
  interest.deviation.col(0).setConstant(0.02);
  const Eigen::MatrixXd more = rigid_variance(fit, match, interest) - of_inputs;
  const Eigen::RowVectorXd wanted = 0.02 * 0.02 * match.input_shapes.row(0).cwiseAbs2();
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_LT((more.row(i) - wanted).norm(), 1e-9 * wanted.norm());
  }
}

// The channels tell of the motion along z alone. Along other directions it was 0 +- 0.
TEST(RigidBand, DoesNotKnowMotionThatIsNotAlongZ) {
  const FreeBar bar;
  simulators::Dice dice(14);
  const auto fit = rigid_fit(bar, 0.01, dice);
  const ChannelGains gains{matched_by_geometry(bar, fit), {}, false};
  const auto none = [](Eigen::Index rows) {
    return Eigen::MatrixXd(Eigen::MatrixXd::Zero(rows, 0));
  };
  const FieldSimulation simulation{
      {Eigen::VectorXd(0), none(4), none(3)}, none(std::ssize(gains.match.rows)), 100.0};
  priors::Places places{Points::Zero(3, 3), Points::Zero(3, 3), none(3)};
  places.position.col(0) = kPlaces;
  places.direction << 0.0, 0.0, -1.0, 1.0, 0.0, 0.0, 0.6, 0.0, 0.8;
  const auto found = places_of_interest(fit, gains, {}, simulation, places, {none(3), none(3)});
  const auto along = interest_of(gains.match);
  EXPECT_LT((found.shapes.row(0) + along.shapes.row(0)).norm(), 1e-12);
  EXPECT_LT((found.deviation.row(0) - along.deviation.row(0)).norm(), 1e-12);
  const Eigen::RowVectorXd size = gains.match.shapes.colwise().norm() /
                                  std::sqrt(static_cast<double>(gains.match.shapes.rows()));
  const auto responses = predicted(fit, gains.match, found, Eigen::VectorXd::Constant(1, 10.0));
  const double square = std::pow(2.0 * std::numbers::pi * 10.0, 2);
  for (const Eigen::Index i : {1, 2}) {
    EXPECT_EQ(found.shapes.row(i).norm(), 0.0);
    EXPECT_LT((found.deviation.row(i) - size).norm(), 1e-12);
    const Eigen::RowVectorXd band =
        (size.cwiseAbs2() * gains.match.input_shapes.cwiseAbs2()).cwiseSqrt() / square;
    EXPECT_LT((responses.deviation[0].row(i) - band).norm(), 1e-9 * band.norm());
  }
}

TEST(RigidBand, StaysUnknownWhereTheBodyIs) {
  const FreeBar bar;
  simulators::Dice dice(13);
  const auto fit = rigid_fit(bar, 0.01, dice);
  auto match = matched_by_geometry(bar, fit);
  match.rigid->inverse_covariance.setConstant(INFINITY);
  const auto interest = interest_of(match);
  EXPECT_TRUE(interest.deviation.array().isInf().all());
  const auto found = predicted(fit, match, interest, Eigen::VectorXd::Constant(1, 10.0));
  EXPECT_TRUE(found.value[0].allFinite());
  EXPECT_TRUE(found.deviation[0].array().isInf().all());
  match.rigid->inverse_covariance = {};
  EXPECT_THROW((void)rigid_deviation(*match.rigid, FreeBar::directions(kPlaces)), InvalidInput);
}

}  // namespace
}  // namespace chladni::identification
