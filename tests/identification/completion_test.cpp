#include "identification/poles/completion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "identification/identified.h"
#include "simulators/frf_cases.h"
#include "simulators/portable_random.h"

namespace chladni::identification {
namespace {

using simulators::FrfCase;
using simulators::FrfFaults;

constexpr double kNotSeen = std::numeric_limits<double>::quiet_NaN();

// The record without some responses (output, input).
FrfCase without_responses(FrfCase made,
                          const std::vector<std::pair<Eigen::Index, Eigen::Index>>& gone) {
  for (auto& line : made.measured.value) {
    for (const auto& [i, j] : gone) line(i, j) = {kNotSeen, kNotSeen};
  }
  return made;
}

Identified found_with_rank(const FrfCase& made) {
  IdentificationOptions options;
  options.rigid_count = -1;
  return identified(fit_data(made.measured), options);
}

template <typename Matrix>
void expect_given_back(const Matrix& exact, MeasuredResponses measured, Eigen::Index rank) {
  const Matrix seen = measured.select(exact, Matrix::Constant(exact.rows(), exact.cols(), 17.0));
  const Matrix full = completed(seen, measured, rank);
  EXPECT_LT((full - exact).norm(), 1e-4 * exact.norm()) << rank;
  // What was measured stays to the last bit, and the order of the channels does not matter.
  EXPECT_TRUE((measured.select(full, exact).array() == exact.array()).all());
  const Matrix turned = completed(Matrix(seen.transpose()), measured.transpose(), rank);
  EXPECT_LT((turned.transpose() - exact).norm(), 1e-4 * exact.norm()) << rank;
}

TEST(Completion, GivesBackWhatALowRankTells) {
  simulators::Dice dice(3);
  for (const Eigen::Index rank : {1, 2, 3}) {
    const Eigen::MatrixXd real = dice.normal(7, rank) * dice.normal(rank, 6);
    MeasuredResponses measured = MeasuredResponses::Constant(7, 6, true);
    measured(1, 0) = measured(1, 4) = measured(5, 4) = measured(6, 2) = false;
    expect_given_back<Eigen::MatrixXd>(real, measured, rank);
    const Eigen::MatrixXcd turns =
        dice.normal(7, rank) + std::complex<double>(0.0, 1.0) * dice.normal(7, rank);
    expect_given_back<Eigen::MatrixXcd>(turns * dice.normal(rank, 6), measured, rank);
  }
}

// Hundreds of sensors: the equations are as large as the shorter side, which takes less than a
// second here. Those of both sides took minutes.
TEST(Completion, GivesBackTheResponsesOfManySensors) {
  simulators::Dice dice(4);
  const Eigen::MatrixXd exact = dice.normal(600, 3) * dice.normal(3, 8);
  MeasuredResponses measured = MeasuredResponses::Constant(600, 8, true);
  for (Eigen::Index i = 0; i < 600; i += 7) measured(i, i % 8) = false;
  expect_given_back<Eigen::MatrixXd>(exact, measured, 3);
}

TEST(Completion, LeavesWhatNothingTells) {
  const Eigen::MatrixXd value{{1.0, 2.0, 0.0}, {2.0, 0.0, 0.0}, {0.0, 0.0, 5.0}, {0.0, 0.0, 0.0}};
  const MeasuredResponses measured = value.array() != 0.0;
  Eigen::MatrixXd expected = value;
  expected(1, 1) = 4.0;
  EXPECT_LT((completed(value, measured, 1) - expected).norm(), 1e-6);
  EXPECT_EQ(completed(value, measured, 0), value);
  const MeasuredResponses all = MeasuredResponses::Constant(4, 3, true);
  EXPECT_EQ(completed(value, all, 1), value);
  EXPECT_EQ(completed(Eigen::MatrixXd::Zero(4, 3).eval(), measured, 2).norm(), 0.0);
  EXPECT_THROW((void)completed((kNotSeen * value).eval(), measured, 1), NumericalFailure);
}

TEST(Completion, FindsTheChannelsThatAreConnected) {
  MeasuredResponses measured = MeasuredResponses::Constant(5, 4, false);
  measured(0, 3) = measured(2, 3) = measured(2, 0) = measured(4, 2) = true;
  const auto parts = connected_channels(measured);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].outputs, (std::vector<Eigen::Index>{0, 2}));
  EXPECT_EQ(parts[0].inputs, (std::vector<Eigen::Index>{0, 3}));
  EXPECT_EQ(parts[1].outputs, std::vector<Eigen::Index>{4});
  EXPECT_EQ(parts[1].inputs, std::vector<Eigen::Index>{2});
}

// A response that was not measured is none of 0: it adds no mode.
TEST(Identified, FindsNoRigidBodyModeInResponsesThatWereNotMeasured) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    FrfFaults faults;
    faults.seed = seed;
    const auto made = simulators::big(6, 5, 9, 800, faults);
    for (const auto& record :
         {without_responses(made, {{1, 1}}), without_responses(made, {{0, 0}, {4, 1}}),
          without_responses(made, {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 0}, {5, 1}})}) {
      const auto found = found_with_rank(record);
      EXPECT_EQ(found.fit.model.rigid_count, 3) << seed;
      EXPECT_EQ(found.fit.model.mode_count(), 9) << seed;
      EXPECT_LT(std::abs(found.fit.excess()), 4.0) << seed;
    }
  }
}

// The responses of outputs 1 and 2 to input 2 and 3 and of the others to input 1 are not there.
const std::vector<std::pair<Eigen::Index, Eigen::Index>> kBetweenParts{
    {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 0}, {3, 0}, {4, 0}};

// Nothing connects the shapes of two parts; the fit says so.
TEST(Identified, SaysThatPartsHaveNoCommonChannel) {
  const auto made = simulators::beam5x3();
  const auto says = [](const Identified& found) {
    return std::ranges::any_of(found.fit.notes, [](const std::string& note) {
      return note.find("2 parts without a response between them") != std::string::npos;
    });
  };
  EXPECT_TRUE(says(found_with_rank(without_responses(made, kBetweenParts))));
  EXPECT_FALSE(says(
      found_with_rank(without_responses(made, {kBetweenParts.begin() + 1, kBetweenParts.end()}))));
}

using Responses = std::vector<std::pair<Eigen::Index, Eigen::Index>>;  // (output, input)

constexpr double kTurn = 2.0 * std::numbers::pi;
const Eigen::Vector3d kOwnHz(40.0, 90.0, 150.0);

// Three modes of 1 % damping. `shapes` has a row for each sensor, `at` the sensor at each actuator;
// `noise` is relative to each response. Only some responses are measured.
FitData three_modes(const Eigen::MatrixXd& shapes, const std::vector<Eigen::Index>& at,
                    const Responses& measured, const std::vector<double>& noise) {
  simulators::Dice dice(3);
  const auto p = shapes.rows();
  const auto q = std::ssize(at);
  FitData data{.outputs = p, .inputs = q, .frequency_hz = {}, .value = {}, .weight = {}};
  data.frequency_hz = Eigen::VectorXd::LinSpaced(391, 5.0, 200.0);
  data.value = Eigen::MatrixXcd::Zero(391, p * q);
  data.weight = Eigen::MatrixXd::Zero(391, p * q);
  for (std::size_t e = 0; e < measured.size(); ++e) {
    const auto [i, j] = measured[e];
    auto response = data.value.col(i + p * j);
    for (Eigen::Index m = 0; m < 3; ++m) {
      const double residue = shapes(i, m) * shapes(at[static_cast<std::size_t>(j)], m);
      for (Eigen::Index k = 0; k < 391; ++k) {
        const double hz = data.frequency_hz(k);
        response(k) +=
            residue / std::complex<double>(kOwnHz(m) * kOwnHz(m) - hz * hz, 0.02 * kOwnHz(m) * hz);
      }
    }
    const double size = noise[e] * response.norm() / std::sqrt(391.0);
    response += size / std::sqrt(2.0) *
                (dice.normal(391, 1).cast<std::complex<double>>() +
                 std::complex<double>(0.0, 1.0) * dice.normal(391, 1).cast<std::complex<double>>());
    data.weight.col(i + p * j).setConstant(1.0 / size);
  }
  return data;
}

// Three modes seen by two sensors from one actuator, and by a third sensor from another: a part has
// modes of its own, which are no group with those of the other part. No digit mixes them.
TEST(Identified, MakesNoGroupOfModesOfDifferentParts) {
  const Eigen::MatrixXd shapes{{1.0, 0.7, -0.5}, {0.6, -0.9, 0.4}, {-0.8, 0.5, 0.9}};
  const auto data =
      three_modes(shapes, {0, 2}, {{0, 0}, {1, 0}, {2, 1}}, std::vector<double>(3, 3e-3));
  const auto fit = identified(data).fit;
  EXPECT_EQ(fit.model.mode_count(), 6);
  EXPECT_EQ(std::ssize(fit.groups), fit.model.mode_count());
}

// Two sensors and two actuators on each of two parts; the responses of the second part are noisier.
const Eigen::MatrixXd kShapesOfTwoParts{
    {1.0, 0.7, -0.5}, {0.6, -0.9, 0.4}, {-0.8, 0.5, 0.9}, {0.5, 0.8, -0.7}};

FitData two_parts() {
  const Responses measured{{0, 0}, {1, 0}, {0, 1}, {1, 1}, {2, 2}, {3, 2}, {2, 3}, {3, 3}};
  std::vector<double> noise(4, 3e-3);
  noise.resize(8, 3e-2);
  return three_modes(kShapesOfTwoParts, {0, 1, 2, 3}, measured, noise);
}

// The true modes at the first channels, each one mode over both parts. The second part's outputs
// are `factor` times too large and its inputs as much too small, which changes no measured
// response.
Start over_parts(Eigen::Index channels, double factor) {
  Start start;
  start.pole.resize(3);
  for (Eigen::Index m = 0; m < 3; ++m) {
    start.pole(m) = kTurn * kOwnHz(m) * std::complex<double>(-0.01, std::sqrt(1.0 - 1e-4));
    Eigen::VectorXd outputs = kShapesOfTwoParts.col(m);
    Eigen::VectorXd inputs = outputs;
    outputs.tail(2) *= factor;
    inputs.tail(2) /= factor;
    start.residue.emplace_back(kTurn * kTurn * outputs.head(channels) *
                               inputs.head(channels).transpose());
  }
  return start;
}

// The first part sees the modes better: there the shapes are known, in the other they are not, as
// no response tells their scale.
void expect_known_in_the_first_part(const ModalFit& fit) {
  ASSERT_EQ(fit.model.mode_count(), 3);
  EXPECT_TRUE(fit.output_std.topRows(2).allFinite());
  EXPECT_TRUE(fit.input_std.leftCols(2).allFinite());
  EXPECT_FALSE(fit.output_std.bottomRows(2).array().isFinite().any());
  EXPECT_FALSE(fit.input_std.rightCols(2).array().isFinite().any());
  EXPECT_GT(fit.output_std.topRows(2).minCoeff(), 0.0);
  for (Eigen::Index m = 0; m < 3; ++m) {
    const Eigen::MatrixXd& covariance = fit.mode_covariance[static_cast<std::size_t>(m)];
    for (const Eigen::Index unknown : {4, 5, 8, 9}) {
      EXPECT_TRUE(std::isinf(covariance(unknown, unknown)));
      EXPECT_EQ((covariance.row(unknown).array() == 0.0).count(), covariance.cols() - 1);
    }
    // The lengths of both sides are equal in each part; the covariance holds that rule.
    const Eigen::Vector2d l = fit.model.output_shapes.col(m).head(2);
    const Eigen::Vector2d r = fit.model.input_shapes.row(m).head(2).transpose();
    EXPECT_NEAR(l.norm(), r.norm(), 1e-9 * l.norm());
    EXPECT_NEAR(fit.model.output_shapes.col(m).tail(2).norm(),
                fit.model.input_shapes.row(m).tail(2).norm(), 1e-9 * l.norm());
    Eigen::Vector4d along;
    along << l, -r;
    const std::vector<Eigen::Index> known{2, 3, 6, 7};
    const Eigen::Matrix4d own = covariance(known, known);
    EXPECT_LT((own * along).norm(), 1e-6 * own.norm() * along.norm());
  }
}

// A mode that two parts see has a scale for each, and the data tell none between them. What it
// starts from decides nothing, and the part that is told is told as by itself.
TEST(ModalFit, KnowsAModeOverTwoPartsInOneOfThem) {
  const auto data = two_parts();
  const auto fit = modal_fit(data, over_parts(4, 1.0));
  expect_known_in_the_first_part(fit);
  const auto scaled = modal_fit(data, over_parts(4, 5.0));
  expect_known_in_the_first_part(scaled);
  const double size = fit.model.output_shapes.cwiseAbs().maxCoeff();
  EXPECT_LT((scaled.model.output_shapes - fit.model.output_shapes).norm(), 1e-3 * size);
  EXPECT_LT((scaled.model.input_shapes - fit.model.input_shapes).norm(), 1e-3 * size);
  const auto alone =
      modal_fit(three_modes(kShapesOfTwoParts.topRows(2), {0, 1}, {{0, 0}, {1, 0}, {0, 1}, {1, 1}},
                            std::vector<double>(4, 3e-3)),
                over_parts(2, 1.0));
  const Eigen::ArrayXXd ratio = fit.output_std.topRows(2).array() / alone.output_std.array();
  EXPECT_LT(ratio.maxCoeff(), 1.05);
  EXPECT_GT(ratio.minCoeff(), 0.7);
  EXPECT_LT((fit.model.output_shapes.topRows(2) - alone.model.output_shapes).cwiseAbs().maxCoeff(),
            3.0 * alone.output_std.maxCoeff());
  // Ten parameters of a mode less one scale for each part, and the constants.
  EXPECT_EQ(fit.parameter_count, 3 * (10 - 2) + 8);
}

TEST(ModalFit, KnowsAComplexModeOverTwoPartsInOneOfThem) {
  const auto fit = modal_fit(two_parts(), over_parts(4, 3.0), {.damping = Damping::general});
  ASSERT_TRUE(fit.complex);
  const auto& shapes = *fit.complex;
  EXPECT_TRUE(shapes.output_real_std.topRows(2).allFinite());
  EXPECT_TRUE(shapes.output_imaginary_std.topRows(2).allFinite());
  EXPECT_TRUE(shapes.input_imaginary_std.leftCols(2).allFinite());
  EXPECT_FALSE(shapes.output_real_std.bottomRows(2).array().isFinite().any());
  EXPECT_FALSE(shapes.output_imaginary_std.bottomRows(2).array().isFinite().any());
  EXPECT_FALSE(shapes.input_real_std.rightCols(2).array().isFinite().any());
  EXPECT_FALSE(shapes.input_imaginary_std.rightCols(2).array().isFinite().any());
  EXPECT_TRUE(fit.frequency_std_hz.allFinite());
  EXPECT_EQ(fit.parameter_count, 3 * (18 - 4) + 8);
  // Modal damping: the imaginary parts are none but noise.
  const Eigen::ArrayXXd off = shapes.outputs.topRows(2).imag().array().abs() /
                              shapes.output_imaginary_std.topRows(2).array();
  EXPECT_LT(off.maxCoeff(), 5.0);
}

}  // namespace
}  // namespace chladni::identification
