#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "gain_case.h"
#include "identification/channel_gains.h"
#include "identification/gain_match.h"
#include "priors/residual/residual_evidence.h"
#include "simulators/tables/plate_study.h"

namespace chladni::identification {
namespace {

TEST(GainWithoutPairs, ScalesSuspendedModesByTheirMotion) {
  const auto made = part(simulators::beam5x5(quiet()), {0, 4}, {1, 2, 3});  // no pair at all
  GainMatchOptions options;
  options.geometry = geometry_of(made, RigidMotion::beam);
  options.geometry->suspended = {0, 1};
  Eigen::MatrixXd deviation;
  for (const double side : {1.0, -1.0}) {
    const auto scaled = rescaled(true_fit(made), kScales);
    const auto fit = side > 0.0 ? scaled : with_turned_inputs(scaled);
    const auto match = matched(made, fit, options);
    if (side > 0.0) deviation = match.deviation.leftCols(2);
    EXPECT_LT((match.deviation.leftCols(2) - deviation).norm(), 1e-9 * deviation.norm());
    const auto truth = truth_at(match, made.truth);
    for (Eigen::Index m = 0; m < 2; ++m) {
      const double sign = kScales(m) > 0.0 ? 1.0 : -1.0;
      EXPECT_EQ(match.modes[static_cast<std::size_t>(m)].by, MatchedBy::geometry);
      EXPECT_EQ(match.modes[static_cast<std::size_t>(m)].sign, side > 0.0 ? 1 : -1);
      EXPECT_LT((match.shapes.col(m) - sign * truth.col(m)).norm(), 1e-7 * truth.col(m).norm());
    }
    EXPECT_EQ(match.modes[2].by, MatchedBy::nothing);
  }
  constexpr int kDraws = 200;
  const auto fit = true_fit(made);
  const auto exact = matched(made, fit, options);
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(5, 2);
  for (int draw = 0; draw < kDraws; ++draw) {
    const auto match = matched(made, drawn_fit(fit, static_cast<unsigned>(draw)), options);
    square += (match.shapes - exact.shapes).leftCols(2).cwiseAbs2() / kDraws;
  }
  const Eigen::ArrayXXd ratio =
      square.cwiseSqrt().cwiseQuotient(exact.deviation.leftCols(2)).array();
  EXPECT_LT((ratio - 1.0).abs().maxCoeff(), 4.5 / std::sqrt(2.0 * kDraws)) << ratio;
}

// 5.2.4 to 5.2.6: rigid-body modes blended in L and differently in R spoil the extended rows; the
// sensors alone, or the motion on both sides, keep them straight.
TEST(GainWithoutPairs, KeepsBlendedSuspensionModesStraight) {
  const auto made = two_by_four();
  auto fit = true_fit(made);
  const Eigen::RowVectorXd other = fit.model.input_shapes.row(1);
  fit.model.input_shapes.row(0) += 0.2 * other;  // only R, as the thesis found it
  const auto bent_of = [&](const GainMatch& match) {
    const Eigen::VectorXd x{{-0.1, 0.2, -0.2, 0.0, 0.1}};
    Eigen::MatrixXd line(5, 2);
    line << Eigen::VectorXd::Ones(5), x;
    const Eigen::VectorXd shape = match.shapes.col(0);
    return (shape - line * line.colPivHouseholderQr().solve(shape)).norm() / shape.norm();
  };
  auto options = with_pairs(made);
  options.rule = GainRule::thesis;
  EXPECT_GT(bent_of(matched(made, fit, options)), 0.05);
  options.geometry = geometry_of(made, RigidMotion::beam);
  options.geometry->suspended = {0, 1};
  const auto straight = matched(made, fit, options);
  EXPECT_LT(bent_of(straight), 1e-12);
  EXPECT_EQ(straight.modes[0].by, MatchedBy::pairs);
  options.rule = GainRule::tied;
  const auto both = matched(made, fit, options);
  EXPECT_LT(bent_of(both), 1e-12);
  const auto blamed = [](const std::string& text) {
    return text.find("a rigid motion") != std::string::npos;
  };
  EXPECT_TRUE(std::ranges::any_of(both.warnings, blamed));
}

TEST(GainWithoutPairs, ScalesModesAtZeroByTheMassMatrix) {
  const auto made = simulators::oat4x13(quiet());
  auto fit = true_fit(made);
  simulators::Dice dice(3);
  const Eigen::Matrix3d blend = dice.normal(3, 3);
  fit.model.output_shapes.leftCols(3) = (fit.model.output_shapes.leftCols(3) * blend).eval();
  fit.model.input_shapes.topRows(3) = (blend.inverse() * fit.model.input_shapes.topRows(3)).eval();
  for (Eigen::Index m = 0; m < 3; ++m) fit.mode_covariance[static_cast<std::size_t>(m)].setZero();
  fit.rigid_covariance.setZero();
  GainMatchOptions options;
  options.geometry = geometry_of(made, RigidMotion::plate);
  const auto match = matched(made, fit, options);
  ASSERT_EQ(match.rows.size(), 17U);
  ASSERT_TRUE(match.rigid.has_value());
  const double mass = 0.6 * 0.5988 * 2700.0 * 0.0149;
  EXPECT_NEAR(match.rigid->mass(0, 0), mass, 1e-6 * mass);
  EXPECT_NEAR(match.rigid->mass(0, 1), 0.0, 1e-9 * mass);
  const auto truth = truth_at(match, made.truth);
  const Eigen::MatrixXd products = match.shapes.leftCols(3) * match.shapes.leftCols(3).transpose();
  const Eigen::MatrixXd wanted = truth.leftCols(3) * truth.leftCols(3).transpose();
  EXPECT_LT((products - wanted).norm(), 1e-9 * wanted.norm());
  EXPECT_EQ(match.modes[0].by, MatchedBy::geometry);
}

TEST(GainWithoutPairs, StatesTheDeviationsOfRowsFromTheMassMatrix) {
  const auto made = simulators::oat4x13(quiet());
  const auto fit = true_fit(made);
  GainMatchOptions options;
  options.geometry = geometry_of(made, RigidMotion::plate);
  const auto exact = matched(made, fit, options);
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(17, 3);
  constexpr int kDraws = 100;
  for (int draw = 0; draw < kDraws; ++draw) {
    const auto match = matched(made, drawn_fit(fit, static_cast<unsigned>(draw)), options);
    square += (match.shapes - exact.shapes).leftCols(3).cwiseAbs2() / kDraws;
  }
  const Eigen::ArrayXXd ratio =
      square.cwiseSqrt().cwiseQuotient(exact.deviation.leftCols(3)).array();
  EXPECT_LT((ratio - 1.0).abs().maxCoeff(), 4.5 / std::sqrt(2.0 * kDraws)) << ratio;
}

// A free plate that moves as a whole, with channels along z.
struct FreePlate {
  Eigen::MatrixX3d sensors, actuators;
  Eigen::MatrixXd inverse_mass{{0.5, 0.1, -0.2}, {0.1, 6.0, 0.4}, {-0.2, 0.4, 5.0}};

  [[nodiscard]] Eigen::MatrixXd products() const {
    return rigid_directions(sensors, RigidMotion::plate) * inverse_mass *
           rigid_directions(actuators, RigidMotion::plate).transpose();
  }
  [[nodiscard]] ModalFit fit(Eigen::Index rigid) const {
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(products(),
                                                Eigen::ComputeThinU | Eigen::ComputeThinV);
    const auto told = std::min(rigid, svd.singularValues().size());
    ModalFit fit;
    fit.model.rigid_count = rigid;
    fit.model.frequency_hz = fit.model.damping_ratio = Eigen::VectorXd::Zero(rigid);
    fit.model.output_shapes = Eigen::MatrixXd::Zero(sensors.rows(), rigid);
    fit.model.input_shapes = Eigen::MatrixXd::Zero(rigid, actuators.rows());
    fit.model.output_shapes.leftCols(told) =
        svd.matrixU().leftCols(told) * svd.singularValues().head(told).asDiagonal();
    fit.model.input_shapes.topRows(told) = svd.matrixV().leftCols(told).transpose();
    return fit;
  }
  [[nodiscard]] modal::FrfSet channels() const {
    modal::FrfSet set;
    const auto add = [](const std::string& letter, const Eigen::MatrixX3d& places,
                        std::vector<modal::MeasuredChannel>& channels) {
      for (Eigen::Index i = 0; i < places.rows(); ++i) {
        modal::MeasuredChannel channel;
        channel.name = letter + std::to_string(i + 1);
        channel.direction = Eigen::Vector3d::UnitZ();
        channel.position = places.row(i).transpose();
        channels.push_back(channel);
      }
    };
    add("y", sensors, set.outputs);
    add("u", actuators, set.inputs);
    return set;
  }
  [[nodiscard]] GainMatch match(Eigen::Index rigid) const {
    return channel_gains(fit(rigid), channels(), {}, {}).match;
  }
};

// Two actuators drive two of a plate's three motions; they are no motions of a beam along x.
TEST(GainWithoutPairs, TakesTwoModesAtZeroForABeamOnItsLineOnly) {
  const Eigen::MatrixX3d places{
      {-0.2, -0.1, 0.0}, {0.2, -0.1, 0.0}, {-0.2, 0.15, 0.0}, {0.2, 0.1, 0.0}};
  FreePlate plate{places, Eigen::MatrixX3d{{-0.1, 0.05, 0.0}, {0.15, -0.05, 0.0}}};
  const auto expect_products = [&](const GainMatch& match) {
    const Eigen::MatrixXd products = plate.products();
    EXPECT_LT((match.shapes.topRows(4) * match.input_shapes - products).norm(),
              1e-9 * products.norm());
  };
  const auto alone = plate.match(2);
  EXPECT_EQ(alone.modes[0].by, MatchedBy::nothing);
  EXPECT_FALSE(alone.rigid.has_value());
  expect_products(alone);
  plate.actuators = places({0, 3}, Eigen::all);
  const auto paired = plate.match(2);
  EXPECT_EQ(paired.modes[0].by, MatchedBy::pairs);
  expect_products(paired);
  EXPECT_LT((paired.shapes.row(3) - paired.input_shapes.col(1).transpose()).norm(),
            1e-9 * paired.shapes.row(3).norm());
  // All at one y, which need not be 0.
  plate.sensors =
      Eigen::MatrixX3d{{-0.2, 0.1, 0.0}, {-0.05, 0.1, 0.0}, {0.1, 0.1, 0.0}, {0.2, 0.1, 0.0}};
  plate.actuators = Eigen::MatrixX3d{{-0.1, 0.1, 0.0}, {0.15, 0.1, 0.0}};
  const auto line = plate.match(2);
  EXPECT_EQ(line.modes[0].by, MatchedBy::geometry);
  EXPECT_TRUE(line.rigid.has_value());
  expect_products(line);
}

bool is_warned(const GainMatch& match, const std::string& of) {
  return std::ranges::any_of(
      match.warnings, [&](const std::string& text) { return text.find(of) != std::string::npos; });
}

TEST(GainWithoutPairs, WarnsWhereThePlacesDoNotTellTheMass) {
  const FreePlate plate{
      Eigen::MatrixX3d{{-0.2, -0.1, 0.0}, {0.2, 0.1, 0.0}},
      Eigen::MatrixX3d{{-0.1, 0.1, 0.0}, {0.1, 0.15, 0.0}, {0.15, -0.1, 0.0}, {-0.1, -0.2, 0.0}}};
  const auto match = plate.match(3);
  EXPECT_EQ(match.modes[0].by, MatchedBy::nothing);
  EXPECT_TRUE(is_warned(match, "do not determine the 3 by 3 mass matrix"));
}

// All actuators turned: two modes of one frequency, scaled together by the pairs, have the same
// deviations.
TEST(GainMatch, KnowsAGroupOfModesAsWellWhereActuatorsAreTurned) {
  const auto made = simulators::pairs(0.0, 0.01, 0.01, quiet());
  ModalFit fit;
  fit.model = made.truth;
  fit.groups = {{0, 1}, {1, 2}, {3, 1}};
  simulators::Dice dice(4);
  const auto n = 2 + made.truth.output_count() + made.truth.input_count();
  for (Eigen::Index m = 0; m < made.truth.mode_count(); ++m) {
    const Eigen::MatrixXd factor = 1e-4 * dice.normal(n, n);
    fit.mode_covariance.emplace_back(factor * factor.transpose());
  }
  const auto straight = matched(made, fit, with_pairs(made));
  const auto turned = matched(made, with_turned_inputs(fit), with_pairs(made));
  const Eigen::MatrixXd group = straight.deviation.middleCols(1, 2);
  ASSERT_TRUE(group.allFinite());
  ASSERT_GT(group.minCoeff(), 0.0);
  EXPECT_LT((turned.deviation.middleCols(1, 2) - group).norm(), 1e-9 * group.norm());
}

TEST(GainWithoutPairs, MatchesABlockByItsPairs) {
  const auto made = simulators::pairs(0.0, 0.01, 0.01, quiet());
  ModalFit fit;
  fit.model = made.truth;
  simulators::Dice dice(9);
  const Eigen::Matrix2d turn = dice.normal(2, 2);
  fit.model.output_shapes.middleCols(1, 2) =
      (fit.model.output_shapes.middleCols(1, 2) * turn).eval();
  fit.model.input_shapes.middleRows(1, 2) =
      (turn.inverse() * fit.model.input_shapes.middleRows(1, 2)).eval();
  fit.groups = {{0, 1}, {1, 2}, {3, 1}};
  const auto match = matched(made, fit, with_pairs(made));
  ASSERT_EQ(match.rows.size(), 4U);
  EXPECT_TRUE(match.warnings.empty());
  const Eigen::MatrixXd block = match.shapes.middleCols(1, 2);
  const Eigen::MatrixXd known = made.truth.output_shapes.middleCols(1, 2);
  EXPECT_LT((block * block.transpose() - known * known.transpose()).norm(),
            1e-10 * known.squaredNorm());
}

// All actuators turned on a free body without pairs: their sign is that of a positive mass, and the
// results are those of actuators along their directions.
TEST(GainWithoutPairs, TellsTheSideOfActuatorsByTheMassAtZero) {
  FreePlate plate{
      Eigen::MatrixX3d{{-0.2, -0.1, 0.0}, {0.2, -0.1, 0.0}, {-0.2, 0.15, 0.0}, {0.2, 0.1, 0.0}},
      Eigen::MatrixX3d{{-0.1, 0.05, 0.0}, {0.15, -0.05, 0.0}, {0.05, 0.2, 0.0}}};
  const auto straight = plate.match(3);
  plate.inverse_mass *= -1.0;  // the products of turned actuators
  const auto turned = plate.match(3);
  ASSERT_TRUE(straight.rigid && turned.rigid);
  EXPECT_TRUE(straight.warnings.empty());
  EXPECT_TRUE(is_warned(turned, "the modes at 0 Hz say that sensors and actuators count in"));
  EXPECT_EQ(straight.side, 1);
  EXPECT_EQ(turned.side, -1);
  for (const auto& mode : turned.modes) {
    EXPECT_EQ(mode.by, MatchedBy::geometry);
    EXPECT_EQ(mode.sign, -1);
  }
  const auto expect_same = [](const Eigen::MatrixXd& one, const Eigen::MatrixXd& other) {
    EXPECT_LT((one - other).norm(), 1e-9 * other.norm());
  };
  expect_same(turned.rigid->mass, straight.rigid->mass);
  expect_same(turned.shapes, straight.shapes);
  expect_same(turned.input_shapes, straight.input_shapes);
  EXPECT_TRUE(turned.deviation.allFinite());
  EXPECT_LT((turned.shapes.topRows(4) * driving_shapes(turned) - plate.products()).norm(),
            1e-9 * plate.products().norm());
}

// Lines that begin far above the rigid body hold noise at 0 Hz alone. Its mass may come out
// negative, but not beyond chance.
TEST(GainWithoutPairs, TurnsNoActuatorsByNoiseAtZero) {
  const FreePlate plate{
      Eigen::MatrixX3d{{-0.2, -0.1, 0.0}, {0.2, -0.1, 0.0}, {-0.2, 0.15, 0.0}, {0.2, 0.1, 0.0}},
      Eigen::MatrixX3d{{-0.1, 0.05, 0.0}, {0.15, -0.05, 0.0}, {0.05, 0.2, 0.0}}};
  simulators::Dice dice(1);
  auto fit = plate.fit(3);
  for (int draw = 0; draw < 400; ++draw) {
    fit.model.output_shapes = dice.normal(4, 3);
    fit.model.input_shapes = dice.normal(3, 3);
    EXPECT_EQ(channel_gains(fit, plate.channels(), {}, {}).match.side, 1) << draw;
  }
}

// The simulation of the wafer table at the channels of a case.
GainPrior table_prior(const simulators::FrfCase& made) {
  const auto grid = simulators::PlateGrid{0.6, 0.5988, 20, 20};
  const auto believed = simulators::plate_modes(
      simulators::uniform_plate(grid, simulators::isotropic_bending(21658.0, 0.33), 40.2), 24);
  const auto places = [&](const std::vector<modal::MeasuredChannel>& channels) {
    Eigen::MatrixX2d all(std::ssize(channels), 2);
    for (std::size_t i = 0; i < channels.size(); ++i) {
      all.row(static_cast<Eigen::Index>(i)) = channels[i].position->head<2>().transpose();
    }
    return simulators::plate_places(believed, all);
  };
  GainPrior prior{places(made.measured.outputs),
                  places(made.measured.inputs),
                  priors::modal_basis(
                      simulators::plate_simulation(believed, simulators::plate_surface(believed))),
                  {}};
  prior.residual.gamma = std::pow(139.0 / believed.frequency_hz(3), 2);
  return prior;
}

TEST(GainWithoutPairs, LeavesAModeAloneThatNoSensorSees) {
  const auto made = simulators::oat4x13(quiet());
  auto fit = true_fit(made);
  fit.model.output_shapes.col(3).setZero();
  GainMatchOptions options;
  options.prior = table_prior(made);
  const auto match = matched(made, fit, options);
  EXPECT_EQ(match.modes[3].by, MatchedBy::nothing);
  EXPECT_EQ(match.modes[4].by, MatchedBy::prior);
  EXPECT_TRUE(is_warned(match, "see nothing of it"));
}

TEST(GainWithoutPairs, AsksTheSimulationWhereThereIsNoPair) {
  const auto made = simulators::oat4x13(quiet());
  GainMatchOptions options;
  options.prior = table_prior(made);
  const auto match = matched(made, true_fit(made), options);
  for (std::size_t m = 3; m < 9; ++m) {
    const auto& mode = match.modes[m];
    EXPECT_EQ(mode.by, MatchedBy::prior);
    EXPECT_NEAR(std::log(mode.alpha), 0.0, 4.0 * mode.alpha_std / mode.alpha) << m;
    EXPECT_LT(mode.alpha_std / mode.alpha, 0.3) << m;
  }
}

// A hammer at one end of a bar and a sensor at the other act along one line. They were a pair, and
// modes that move the ends against each other had the wrong sign.
TEST(ChannelPairs, OfTheTwoEndsOfABarAreNone) {
  ModalFit fit;
  fit.model.frequency_hz = Eigen::VectorXd::Constant(1, 2500.0);
  fit.model.damping_ratio = Eigen::VectorXd::Constant(1, 1e-3);
  fit.model.output_shapes = Eigen::MatrixXd::Constant(1, 1, 0.8);
  fit.model.input_shapes = Eigen::MatrixXd::Constant(1, 1, -0.8);
  fit.model.residual = Eigen::MatrixXd::Zero(1, 1);
  GainSimulation bar;
  bar.size_m = [] { return 1.0; };
  bar.at_channels = [] {
    const auto one = Eigen::MatrixXd::Constant(1, 1, 0.8);
    return SimulatedChannels{Eigen::VectorXd::Constant(1, 2500.0), one, 0.7 * one};
  };
  const auto gains = [&](double x) {
    modal::FrfSet set;
    modal::MeasuredChannel channel;
    channel.direction = Eigen::Vector3d::UnitX();
    channel.position = Eigen::Vector3d::Zero();
    set.outputs = {channel};
    channel.position = Eigen::Vector3d(x, 0.0, 0.0);
    set.inputs = {channel};
    return channel_gains(fit, set, {}, bar);
  };
  EXPECT_TRUE(gains(1.0).pairs.empty());
  EXPECT_TRUE(gains(0.5).pairs.empty());
  const auto near = gains(0.2);
  ASSERT_EQ(near.pairs.size(), 1U);
  EXPECT_FALSE(near.pairs[0].is_one_place());  // the simulation tells how far both move
  const auto faces = gains(0.02);
  ASSERT_EQ(faces.pairs.size(), 1U);
  EXPECT_TRUE(faces.pairs[0].is_one_place());
}

// Along a bar all places lie on one line. The sensor beside the actuator is its pair, whatever the
// order of the channels, and whatever rounding does to places.
TEST(ChannelPairs, OfOneLineAreThoseAtOnePlace) {
  for (const bool turned : {false, true}) {
    modal::FrfSet set;
    for (const double x : {0.6, 0.0}) {
      modal::MeasuredChannel channel;
      channel.direction = Eigen::Vector3d::UnitX();
      channel.position = Eigen::Vector3d(x, x == 0.0 ? 1e-12 : 0.0, 0.0);
      set.outputs.push_back(channel);
    }
    if (turned) std::swap(set.outputs[0], set.outputs[1]);
    set.inputs = {set.outputs[turned ? 0 : 1]};
    set.inputs[0].position = Eigen::Vector3d::Zero();
    const auto pairs = channel_pairs({}, set);
    ASSERT_EQ(pairs.size(), 1U);
    EXPECT_EQ(pairs[0].output, turned ? 0 : 1);
  }
}

}  // namespace
}  // namespace chladni::identification
