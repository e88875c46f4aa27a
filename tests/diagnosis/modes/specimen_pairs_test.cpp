// Laws of the pairs of a specimen's modes that are seen at one or two channels.
#include "diagnosis/modes/specimens/pairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ranges>
#include <utility>
#include <vector>

#include "base/index.h"
#include "simulators/portable_random.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

MeasuredModes measured_at(std::vector<double> hz) {
  std::ranges::sort(hz);
  MeasuredModes modes;
  const auto count = static_cast<Index>(hz.size());
  modes.frequency_hz = Eigen::Map<VectorXd>(hz.data(), count);
  modes.frequency_std = VectorXd::Zero(count);
  modes.damping_ratio = modes.damping_std = VectorXd::Constant(count, std::nan(""));
  modes.output_shapes = Eigen::MatrixXcd::Zero(0, count);
  modes.input_shapes = Eigen::MatrixXcd::Zero(0, count);
  modes.output_std = modes.input_std = Eigen::MatrixXd::Zero(0, count);
  return modes;
}

RecordedModes model_at(std::vector<double> hz) {
  std::ranges::sort(hz);
  RecordedModes modes;
  const auto count = static_cast<Index>(hz.size());
  modes.frequency_hz = Eigen::Map<VectorXd>(hz.data(), count);
  modes.damping_ratio = VectorXd::Constant(count, 0.01);
  modes.outputs = modes.inputs = Eigen::MatrixXd::Zero(0, count);
  return modes;
}

std::vector<Index> pairs(std::vector<double> measured, std::vector<double> model) {
  return pairs_in_order(measured_at(std::move(measured)), model_at(std::move(model))).model;
}

const std::vector<double> kModel{47.0, 75.0, 128.0, 163.0, 190.0, 209.0, 255.0, 277.0};

TEST(PairsInOrder, AreThoseOfTheSameModes) {
  std::vector<double> measured = kModel;
  for (auto& hz : measured) hz *= 1.012;
  EXPECT_EQ(pairs(measured, kModel), (std::vector<Index>{0, 1, 2, 3, 4, 5, 6, 7}));
}

TEST(PairsInOrder, LeaveAStrayModeWithoutPartner) {
  const std::vector<double> measured{47.1, 75.2, 128.3, 133.0, 163.2, 191.0, 209.3, 256.0, 277.4};
  EXPECT_EQ(pairs(measured, kModel), (std::vector<Index>{0, 1, 2, -1, 3, 4, 5, 6, 7}));
}

TEST(PairsInOrder, PassOverModesThatWereNotSeen) {
  const std::vector<double> measured{47.1, 75.2, 128.3, 209.3, 256.0};
  EXPECT_EQ(pairs(measured, kModel), (std::vector<Index>{0, 1, 2, 5, 6}));
}

TEST(PairsInOrder, OfNothingAreNone) {
  EXPECT_TRUE(pairs({}, kModel).empty());
  EXPECT_EQ(pairs({50.0, 60.0}, {}), (std::vector<Index>{-1, -1}));
}

TEST(PairsInOrder, DoNotDependOnTheUnitOfFrequency) {
  simulators::Dice dice(4);
  std::vector<double> measured;
  for (const double hz : kModel) measured.push_back(hz * std::exp(0.03 * dice.normal()));
  auto scaled = measured, model = kModel;
  for (auto& hz : scaled) hz *= 16.0;
  for (auto& hz : model) hz *= 16.0;
  EXPECT_EQ(pairs(scaled, model), pairs(measured, kModel));
}

// The least misfit of all alignments, one by one. `unseen` of each simulated mode, `stray`: costs.
double least_of_all(const VectorXd& measured, const VectorXd& model, Index i, Index k) {
  if (i == measured.size() && k == model.size()) return 0.0;
  double least = HUGE_VAL;
  if (i < measured.size()) least = 4.0 + least_of_all(measured, model, i + 1, k);
  if (k < model.size()) {
    const bool is_between = model(k) > measured(0) && model(k) < measured(measured.size() - 1);
    least = std::min(least, (is_between ? 1.0 : 0.0) + least_of_all(measured, model, i, k + 1));
  }
  if (i < measured.size() && k < model.size()) {
    const double off = std::log(measured(i) / model(k)) / 0.02;
    least = std::min(least, std::min(off * off, 4.0) + least_of_all(measured, model, i + 1, k + 1));
  }
  return least;
}

TEST(PairsInOrder, HaveTheLeastMisfitOfAllAlignments) {
  simulators::Dice dice(9);
  for (int draw = 0; draw < 40; ++draw) {
    std::vector<double> measured, model;
    for (int i = 0; i < 5; ++i) measured.push_back(100.0 * std::exp(0.2 * dice.normal()));
    for (int k = 0; k < 6; ++k) model.push_back(100.0 * std::exp(0.2 * dice.normal()));
    const auto seen = measured_at(measured);
    const auto simulated = model_at(model);
    const Matching found = pairs_in_order(seen, simulated);
    double misfit = square_misfit(seen, simulated, found);
    for (Index k = 0; k < simulated.count(); ++k) {
      const double hz = simulated.frequency_hz(k);
      const bool is_between = hz > seen.frequency_hz(0) && hz < seen.frequency_hz(4);
      if (is_between && std::ranges::find(found.model, k) == found.model.end()) misfit += 1.0;
    }
    EXPECT_NEAR(misfit, least_of_all(seen.frequency_hz, simulated.frequency_hz, 0, 0), 1e-9)
        << "draw " << draw;
    EXPECT_TRUE(
        std::ranges::is_sorted(found.model | std::views::filter([](Index k) { return k >= 0; })));
  }
}

}  // namespace
}  // namespace chladni::diagnosis
