#include "identification/poles/completion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
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

// Three modes seen by two sensors from one actuator, and by a third sensor from another: a part has
// modes of its own, which are no group with those of the other part. No digit mixes them.
TEST(Identified, MakesNoGroupOfModesOfDifferentParts) {
  simulators::Dice dice(3);
  FitData data{.outputs = 3, .inputs = 2, .frequency_hz = {}, .value = {}, .weight = {}};
  data.frequency_hz = Eigen::VectorXd::LinSpaced(391, 5.0, 200.0);
  data.value = Eigen::MatrixXcd::Zero(391, 6);
  data.weight = Eigen::MatrixXd::Zero(391, 6);
  const Eigen::MatrixXd shapes{{1.0, 0.7, -0.5}, {0.6, -0.9, 0.4}, {-0.8, 0.5, 0.9}};
  const Eigen::Vector3d own_hz(40.0, 90.0, 150.0);
  for (const auto& [i, j] :
       std::vector<std::pair<Eigen::Index, Eigen::Index>>{{0, 0}, {1, 0}, {2, 1}}) {
    auto response = data.value.col(i + 3 * j);
    for (Eigen::Index m = 0; m < 3; ++m) {
      const double residue = shapes(i, m) * shapes(j == 0 ? 0 : 2, m);
      for (Eigen::Index k = 0; k < 391; ++k) {
        const double hz = data.frequency_hz(k);
        response(k) +=
            residue / std::complex<double>(own_hz(m) * own_hz(m) - hz * hz, 0.02 * own_hz(m) * hz);
      }
    }
    const double noise = 3e-3 * response.norm() / std::sqrt(391.0);
    response += noise / std::sqrt(2.0) *
                (dice.normal(391, 1).cast<std::complex<double>>() +
                 std::complex<double>(0.0, 1.0) * dice.normal(391, 1).cast<std::complex<double>>());
    data.weight.col(i + 3 * j).setConstant(1.0 / noise);
  }
  const auto fit = identified(data).fit;
  EXPECT_EQ(fit.model.mode_count(), 6);
  EXPECT_EQ(std::ssize(fit.groups), fit.model.mode_count());
}

}  // namespace
}  // namespace chladni::identification
