// Responses at places that no sensor measures.
#include "identification/spatio_temporal.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "base/error.h"
#include "identification/fit_data.h"
#include "identification/observed_plant.h"
#include "known_fit.h"
#include "tests/identification/gains/gain_case.h"

namespace chladni::identification {
namespace {

using simulators::FrfCase;
using simulators::FrfFaults;

struct Matched {
  FrfCase made;
  ModalFit fit;
  GainMatch match;
};

Matched sensed_beam() {
  FrfFaults faults;
  faults.delay_s = 3e-4;
  auto made = simulators::beam5x5(faults);
  auto fit = true_fit(made);
  fit.delay_s = faults.delay_s;
  auto match = matched(made, fit, with_pairs(made));
  return {std::move(made), std::move(fit), std::move(match)};
}

// Rows of the sensors themselves.
PlacesOfInterest sensors_of(const Matched& one) {
  const auto p = one.fit.model.output_count();
  return {one.match.shapes.topRows(p), one.match.deviation.topRows(p), one.made.truth.residual};
}

TEST(SpatioTemporal, GivesTheSensorsOwnResponsesBack) {
  const auto one = sensed_beam();
  const auto& lines = one.made.measured.frequency_hz;
  const auto found = predicted(one.fit, one.match, sensors_of(one), lines);
  for (std::size_t k = 0; k < found.value.size(); k += 7) {
    EXPECT_LT((found.value[k] - one.made.exact[k]).norm(), 1e-9 * one.made.exact[k].norm()) << k;
  }
}

// Whatever way the actuators count, all models from them have the signs of the data: the responses
// at the sensors' places are those that were measured, and a point at a sensor moves as the sensor.
TEST(SpatioTemporal, HasTheSignsOfTheDataWhereActuatorsAreTurned) {
  auto one = sensed_beam();
  const Eigen::MatrixXd residual = one.fit.model.residual;
  for (const double side : {1.0, -1.0}) {
    if (side < 0.0) one.fit = with_turned_inputs(one.fit);
    one.fit.model.residual = side * residual;
    one.match = matched(one.made, one.fit, with_pairs(one.made));
    EXPECT_EQ(one.match.side, side);
    auto interest = sensors_of(one);
    interest.residual = one.fit.model.residual;
    const Eigen::VectorXd lines = Eigen::Vector3d(3.0, 33.0, 80.0);
    const auto measured = responses(one.fit, lines);
    const auto found = predicted(one.fit, one.match, interest, lines);
    const auto driven = modal::frf(driven_model(one.fit, one.match), lines);
    ObservedPlaces places;
    for (int i = 0; i < 5; ++i) places.points.push_back("p" + std::to_string(i));
    places.at_points = interest;
    const auto plant = observed_plant(one.fit, one.match, one.made.measured.outputs,
                                      one.made.measured.inputs, places);
    for (Eigen::Index k = 0; k < lines.size(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      const Eigen::MatrixXcd real = measured.row(k).reshaped(5, 5);
      const auto delay = std::polar(1.0, 2.0 * std::numbers::pi * lines(k) * one.fit.delay_s);
      EXPECT_LT((found.value[at] - real).norm(), 1e-9 * real.norm()) << side;
      EXPECT_LT((driven.value[at].topRows(5) - delay * real).norm(), 1e-9 * real.norm()) << side;
      const Eigen::MatrixXcd both = modal::response(plant, lines(k));
      EXPECT_LT((both.topRows(5) - real).norm(), 1e-9 * real.norm()) << side;
      EXPECT_LT((both.bottomRows(5) - real).norm(), 1e-9 * real.norm()) << side;
    }
    auto data = fit_data(modal::part(one.made.measured, {3}, {0, 1, 2, 3, 4}));
    data.value *= side;
    const Eigen::RowVectorXd row = fitted_row(one.fit, one.match, data).shape;
    EXPECT_LT((row - one.match.shapes.row(3)).norm(), 2e-3 * row.norm()) << side;
  }
}

TEST(SpatioTemporal, IsTheStateSpaceThatItExports) {
  auto one = sensed_beam();
  const auto interest = sensors_of(one);
  const Eigen::VectorXd lines = Eigen::Vector3d(3.0, 33.0, 80.0);
  for (const auto of : {DelayOf::all, DelayOf::inputs, DelayOf::outputs}) {
    one.fit.delay_of = of;
    if (of != DelayOf::all) one.fit.channel_delay_s = 1e-4 * Eigen::VectorXd::LinSpaced(5, -2, 2);
    const auto responses = modal::frf(model_at(one.fit, one.match, interest), lines);
    const auto found = predicted(one.fit, one.match, interest, lines);
    const Eigen::VectorXd late = input_delays(one.fit);
    EXPECT_NEAR(late.mean(), one.fit.delay_s, 1e-12);
    for (Eigen::Index k = 0; k < lines.size(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      for (Eigen::Index j = 0; j < 5; ++j) {
        const auto turn = std::polar(1.0, 2.0 * std::numbers::pi * lines(k) * late(j));
        EXPECT_LT((turn * found.value[at].col(j) - responses.value[at].col(j)).norm(),
                  1e-12 * responses.value[at].norm());
      }
    }
  }
}

// What is not known of one place is no more known of its responses, and of no other's.
TEST(SpatioTemporal, ADeviationThatIsNotKnownStaysUnknown) {
  const auto one = sensed_beam();
  const auto& lines = one.made.measured.frequency_hz;
  const auto known = predicted(one.fit, one.match, sensors_of(one), lines);
  for (const double unknown : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    auto interest = sensors_of(one);
    interest.deviation(1, 2) = unknown;
    const auto found = predicted(one.fit, one.match, interest, lines);
    for (std::size_t k = 0; k < found.deviation.size(); k += 50) {
      for (Eigen::Index j = 0; j < 5; ++j) EXPECT_TRUE(std::isinf(found.deviation[k](1, j)));
      for (const Eigen::Index i : {0, 2, 3, 4}) {
        EXPECT_EQ(found.deviation[k].row(i), known.deviation[k].row(i));
      }
    }
  }
  auto fit = one.fit;  // likewise of an actuator, at all places
  fit.mode_covariance[1](2 + 5 + 3, 2 + 5 + 3) = std::numeric_limits<double>::infinity();
  const auto match = matched(one.made, fit, with_pairs(one.made));
  const auto found = predicted(fit, match, sensors_of(one), lines);
  EXPECT_TRUE((found.deviation[100].col(3).array().isInf()).all());
  EXPECT_TRUE(found.deviation[100].leftCols(3).allFinite());
  fit.mode_covariance[1](0, 0) = std::numeric_limits<double>::infinity();  // and of a pole, at all
  const auto of_pole =
      predicted(fit, matched(one.made, fit, with_pairs(one.made)), sensors_of(one), lines);
  EXPECT_TRUE(of_pole.deviation[100].array().isInf().all());
}

// The beam with these sensors and actuators of its five.
Matched part_of_beam(const std::vector<Eigen::Index>& outputs,
                     const std::vector<Eigen::Index>& inputs) {
  auto made = part(simulators::beam5x5(FrfFaults{}), outputs, inputs);
  auto fit = true_fit(made);
  auto match = matched(made, fit, with_pairs(made));
  return {std::move(made), std::move(fit), std::move(match)};
}

// The same with poles and both sides drawn, and matched anew.
Matched drawn_of(const Matched& one, simulators::Dice& dice) {
  auto drawn = one;
  auto& model = drawn.fit.model;
  for (Eigen::Index m = 0; m < model.mode_count(); ++m) {
    const Eigen::VectorXd error =
        normal_draw(one.fit.mode_covariance[static_cast<std::size_t>(m)], dice);
    model.frequency_hz(m) += error(0) / (2.0 * std::numbers::pi);
    model.damping_ratio(m) += error(1);
    model.output_shapes.col(m) += error.segment(2, model.output_count());
    model.input_shapes.row(m) += error.tail(model.input_count()).transpose();
  }
  drawn.match = matched(drawn.made, drawn.fit, with_pairs(drawn.made));
  return drawn;
}

// Root mean square of what draws of the fit, and of `off` of each shape at the sensors, change of
// the responses, over the stated deviation: one ratio for each line and response.
std::vector<Eigen::ArrayXXd> scatter_over_stated(const Matched& one, double off,
                                                 const Eigen::VectorXd& lines) {
  auto interest = sensors_of(one);
  interest.deviation =
      (interest.deviation.array().square() + (off * interest.shapes.array()).square()).sqrt();
  const auto stated = predicted(one.fit, one.match, interest, lines);
  simulators::Dice dice(6);
  std::vector<Eigen::ArrayXXd> ratio(stated.value.size());
  for (std::size_t k = 0; k < ratio.size(); ++k)
    ratio[k].setZero(stated.value[k].rows(), stated.value[k].cols());
  constexpr int kDraws = 800;
  for (int draw = 0; draw < kDraws; ++draw) {
    const auto drawn = drawn_of(one, dice);
    auto there = sensors_of(drawn);
    there.shapes.array() *=
        1.0 + off * dice.normal(there.shapes.rows(), there.shapes.cols()).array();
    const auto found = predicted(drawn.fit, drawn.match, there, lines);
    for (std::size_t k = 0; k < ratio.size(); ++k) {
      ratio[k] += (found.value[k] - stated.value[k]).cwiseAbs2().array() / kDraws;
    }
  }
  for (std::size_t k = 0; k < ratio.size(); ++k)
    ratio[k] = ratio[k].sqrt() / stated.deviation[k].array();
  return ratio;
}

// The deviation is the root mean square of draws. What is wrong of the amplitude of a mode is wrong
// of its row and of its input vector alike, the more so the fewer channels tell it.
TEST(SpatioTemporal, SaysHowFarDrawsScatter) {
  const Eigen::VectorXd lines = (Eigen::VectorXd(4) << 4.0, 20.0, 32.6, 109.0).finished();
  using Channels = std::vector<Eigen::Index>;
  const Channels all{0, 1, 2, 3, 4};
  for (const auto& [outputs, inputs] : {std::pair{all, all}, std::pair{Channels{1, 4}, Channels{1}},
                                        std::pair{Channels{1}, Channels{1, 4}}}) {
    for (const double off : {0.0, 0.003}) {
      const auto ratio = scatter_over_stated(part_of_beam(outputs, inputs), off, lines);
      for (std::size_t k = 0; k < ratio.size(); ++k) {
        EXPECT_NEAR(ratio[k].mean(), 1.0, 0.07) << lines(static_cast<Eigen::Index>(k));
        EXPECT_LT(ratio[k].maxCoeff(), 1.2);
        EXPECT_GT(ratio[k].minCoeff(), 0.8);
      }
    }
  }
}

// A delay that is not known turns the response by ω δτ.
TEST(SpatioTemporal, HasTheDelayInItsBand) {
  auto one = sensed_beam();
  const Eigen::VectorXd lines = Eigen::Vector3d(3.0, 33.0, 109.0);
  const auto interest = sensors_of(one);
  const auto known = predicted(one.fit, one.match, interest, lines);
  one.fit.delay_std_s = 2e-5;
  const auto unsure = predicted(one.fit, one.match, interest, lines);
  for (std::size_t k = 0; k < 3; ++k) {
    const double turn = 2.0 * std::numbers::pi * lines(static_cast<Eigen::Index>(k)) * 2e-5;
    const Eigen::ArrayXXd more =
        unsure.deviation[k].array().square() - known.deviation[k].array().square();
    EXPECT_LT((more - turn * turn * known.value[k].cwiseAbs2().array()).abs().maxCoeff(),
              1e-6 * unsure.deviation[k].cwiseAbs2().maxCoeff());
  }
}

// Delays of actuators have their own deviations; those of sensors scatter about their mean.
TEST(SpatioTemporal, HasTheDelaysOfChannelsInItsBand) {
  auto one = sensed_beam();
  const Eigen::VectorXd line = Eigen::VectorXd::Constant(1, 50.0);
  const auto interest = sensors_of(one);
  const auto known = predicted(one.fit, one.match, interest, line);
  const double omega = 2.0 * std::numbers::pi * 50.0;
  const auto delay_std = [&](Eigen::Index input) {
    const auto unsure = predicted(one.fit, one.match, interest, line);
    const double more =
        std::pow(unsure.deviation[0](1, input), 2) - std::pow(known.deviation[0](1, input), 2);
    return std::sqrt(more) / (omega * std::abs(unsure.value[0](1, input)));
  };
  one.fit.delay_of = DelayOf::inputs;
  one.fit.channel_delay_s = Eigen::VectorXd::Zero(5);
  one.fit.channel_delay_std_s = 1e-4 * Eigen::VectorXd::LinSpaced(5, 1.0, 5.0);
  for (Eigen::Index j = 0; j < 5; ++j) {
    EXPECT_NEAR(delay_std(j), 1e-4 * static_cast<double>(j + 1), 1e-8);
  }
  one.fit.delay_of = DelayOf::outputs;
  one.fit.channel_delay_s = Eigen::VectorXd{{-2e-4, -1e-4, 0.0, 1e-4, 2e-4}};
  EXPECT_NEAR(delay_std(2), std::sqrt(1e-7 / 4.0), 1e-8);
  // A sensor that was not measured has no delay, whatever stands in its place.
  one.fit.channel_delay_s(4) = -3e-3;
  one.fit.channel_delay_std_s(4) = std::numeric_limits<double>::infinity();
  EXPECT_NEAR(delay_std(2), std::sqrt(5e-8 / 3.0), 1e-8);
}

TEST(SpatioTemporal, FindsTheRowOfAFurtherSensor) {
  const auto one = sensed_beam();
  auto data = fit_data(modal::part(one.made.measured, {3}, {0, 1, 2, 3, 4}));
  const auto noisy = fitted_row(one.fit, one.match, data);
  const Eigen::RowVectorXd truth = one.match.shapes.row(3);
  const Eigen::ArrayXd off =
      (noisy.shape - truth).transpose().array() / noisy.deviation.transpose().array();
  EXPECT_LT(off.abs().maxCoeff(), 4.0);
  EXPECT_LT((noisy.shape - truth).norm(), 2e-3 * truth.norm());
}

// A mode that no actuator drives is not known at a further sensor, and not known to be 0 there.
TEST(SpatioTemporal, DoesNotKnowTheRowOfAModeThatNothingDrives) {
  auto one = sensed_beam();
  one.match.input_shapes.row(2).setZero();
  const auto data = fit_data(modal::part(one.made.measured, {3}, {0, 1, 2, 3, 4}));
  const auto row = fitted_row(one.fit, one.match, data);
  for (Eigen::Index m = 0; m < row.deviation.size(); ++m) {
    EXPECT_EQ(std::isinf(row.deviation(m)), m == 2) << m;
  }
}

TEST(SpatioTemporal, RefusesWhatDoesNotFit) {
  const auto one = sensed_beam();
  auto interest = sensors_of(one);
  interest.shapes.conservativeResize(5, 4);
  EXPECT_THROW((void)predicted(one.fit, one.match, interest, Eigen::VectorXd::Ones(1)),
               InvalidInput);
}

TEST(SpatioTemporal, RefusesComplexShapesWithoutImaginaryParts) {
  auto one = sensed_beam();
  one.fit.complex.emplace();
  EXPECT_THROW((void)predicted(one.fit, one.match, sensors_of(one), Eigen::VectorXd::Ones(1)),
               InvalidInput);
}

}  // namespace
}  // namespace chladni::identification
