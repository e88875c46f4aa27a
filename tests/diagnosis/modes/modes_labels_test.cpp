#include "diagnosis/modes/labels/labels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "diagnosis/diagnosed_modes.h"
#include "diagnosis/hypothesis.h"
#include "diagnosis/modes/labelled_rig.h"
#include "diagnosis/modes/labels/label_orders.h"
#include "rotation/turn.h"
#include "tests/diagnosis/small_plate.h"

namespace chladni::diagnosis {
namespace {

using Eigen::Index;
using simulators::Dice;
using simulators::real_rig_case;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::string told(const Labels& labels) {
  std::string text;
  for (const auto& cause : labels.causes) {
    text += cause.effect + " P " + std::to_string(cause.probability) + " ln evidence " +
            std::to_string(cause.log_evidence_gain) + ": " + cause.option + "\n";
  }
  for (const auto& note : labels.notes) text += note + "\n";
  return text;
}

// The labels are right again, and exactly those that were moved are told.
void expect_right(const Labels& labels, const MeasuredModes& right,
                  const std::vector<Index>& order) {
  ASSERT_EQ(labels.causes.size(), 1U) << told(labels);
  const auto& cause = labels.causes.front();
  EXPECT_EQ(cause.effect, "permuted_sensors");
  EXPECT_GT(cause.probability, 0.8) << told(labels);
  std::vector<std::string> records, sensors;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (order[i] == static_cast<Index>(i)) continue;
    records.push_back(right.outputs[i]);
    sensors.push_back(right.outputs[at(order[i])]);
  }
  EXPECT_EQ(cause.channels, records) << told(labels);
  EXPECT_EQ(cause.truly, sensors) << told(labels);
  EXPECT_NE(cause.option.find("record " + records[0] + " is sensor " + sensors[0]),
            std::string::npos)
      << cause.option;
  const auto& shapes = labels.measured.output_shapes;
  for (Index i = 0; i < shapes.size(); ++i) {
    const auto expected = right.output_shapes.data()[i];
    const bool is_nan = std::isnan(expected.real());
    EXPECT_TRUE(is_nan ? std::isnan(shapes.data()[i].real()) : shapes.data()[i] == expected) << i;
  }
}

struct Case {
  MeasuredModes right, mixed;
  std::vector<Index> order;
};
Case case_of(const std::string& body, const std::string& kind, Index count, unsigned seed) {
  const auto rig = real_rig_case(body, kind, seed);
  Dice dice(seed + 500);
  const Index p = believed(body).output_count();
  Case made{rig.modes, {}, some_order(p, count < 0 ? p : count, dice)};
  made.mixed = mixed(made.right, made.order);
  return made;
}

// Body, number of labels that are mixed (−1: all), seed.
class MixedLabels : public testing::TestWithParam<std::tuple<const char*, int, unsigned>> {};

TEST_P(MixedLabels, ArePutRight) {
  EVERY_FOURTH_LANDING();
  const auto& [body, count, seed] = GetParam();
  const auto made = case_of(body, "none", count, seed);
  expect_right(labels_of(believed(body), made.mixed, {}), made.right, made.order);
}

INSTANTIATE_TEST_SUITE_P(Rigs, MixedLabels,
                         testing::Combine(testing::Values("table", "ell", "disc"),
                                          testing::Values(3, 5, -1), testing::Values(1U)));

// Whatever else is hidden, and at any error of the model.
class RightLabels : public testing::TestWithParam<std::tuple<const char*, const char*>> {};

TEST_P(RightLabels, Stay) {
  EVERY_FOURTH_LANDING();
  const auto& [body, kind] = GetParam();
  for (unsigned seed = 1; seed <= 2; ++seed) {
    simulators::RealRigOptions options;
    if (seed == 2) options.frequency_error = 0.03, options.shape_error = 0.1;
    const auto rig = real_rig_case(body, kind, seed, options);
    const auto labels = labels_of(believed(body), rig.modes, {});
    EXPECT_TRUE(labels.causes.empty() && labels.notes.empty()) << seed << ": " << told(labels);
    EXPECT_EQ(labels.measured.output_std, rig.modes.output_std);
  }
}

INSTANTIATE_TEST_SUITE_P(Rigs, RightLabels,
                         testing::Combine(testing::Values("table", "ell", "disc"),
                                          testing::Values("none", "youngs_modulus", "point_mass",
                                                          "local_stiffness", "sensor_gain",
                                                          "sensor_sign", "swapped_sensors")));

// A modulus that is far off moves all frequencies by one factor and no label.
TEST(Labels, StayWhereAllFrequenciesAreFarOff) {
  EVERY_FOURTH_LANDING();
  for (const auto* body : {"table", "ell", "disc"}) {
    auto modes = real_rig_case(body, "none", 1).modes;
    const Eigen::VectorXd hz = modes.frequency_hz;
    for (const double factor : {0.55, 0.7, 1.4, 1.6, 1.9}) {
      modes.frequency_hz = factor * hz;
      const auto labels = labels_of(believed(body), modes, {});
      EXPECT_TRUE(labels.causes.empty() && labels.notes.empty()) << body << factor << told(labels);
    }
  }
}

// Shapes of another structure fit in no order.
TEST(Labels, OfShapesThatFitInNoOrderAreNotPutRight) {
  EVERY_FOURTH_LANDING();
  for (unsigned seed = 1; seed <= 3; ++seed) {
    auto modes = real_rig_case("ell", "none", seed).modes;
    Dice dice(seed);
    for (auto& value : modes.output_shapes.reshaped()) value *= dice.normal();
    const auto labels = labels_of(believed("ell"), modes, {});
    EXPECT_TRUE(labels.causes.empty()) << told(labels);
  }
}

// A complex factor of each mode, of either sign, is not known and changes nothing.
TEST(Labels, DoNotDependOnFactorsOfModes) {
  EVERY_FOURTH_LANDING();
  auto made = case_of("ell", "none", 5, 4);
  Dice dice(9);
  const auto turn = [&](MeasuredModes& modes, Index k, std::complex<double> factor) {
    modes.output_shapes.col(k) *= factor;
    modes.output_std.col(k) *= std::abs(factor);
    modes.input_shapes.col(k) /= factor;
    modes.input_std.col(k) /= std::abs(factor);
  };
  for (Index k = 0; k < made.right.count(); ++k) {
    const auto factor = std::polar(std::exp(dice.normal()), dice.between(-3.1, 3.1));
    turn(made.right, k, factor);
    turn(made.mixed, k, factor);
    if (k % 3 == 0) turn(made.right, k, -1.0), turn(made.mixed, k, -1.0);
  }
  expect_right(labels_of(believed("ell"), made.mixed, {}), made.right, made.order);
}

TEST(Labels, MayLackValues) {
  EVERY_FOURTH_LANDING();
  auto made = case_of("disc", "none", 5, 5);
  Dice dice(3);
  const auto& shapes = made.right.output_shapes;
  for (int n = 0; n < shapes.size() / 10; ++n) {
    const Index row = dice.below(shapes.rows());
    const Index k = dice.below(shapes.cols());
    made.right.output_shapes(row, k) = {kNone, kNone};
  }
  made.mixed = mixed(made.right, made.order);
  expect_right(labels_of(believed("disc"), made.mixed, {}), made.right, made.order);
}

// A turned record neither hinders nor is turned back: it is a cause of its own.
TEST(Labels, AreRightBesideATurnedRecord) {
  EVERY_FOURTH_LANDING();
  auto made = case_of("ell", "none", 4, 6);
  made.right.output_shapes.row(2) *= -1.0;
  made.mixed = mixed(made.right, made.order);
  expect_right(labels_of(believed("ell"), made.mixed, {}), made.right, made.order);
}

TEST(Labels, OfTwoAreLeftToTheSwap) {
  EVERY_FOURTH_LANDING();
  const auto made = case_of("ell", "none", 2, 7);
  const auto labels = labels_of(believed("ell"), made.mixed, {});
  EXPECT_TRUE(labels.causes.empty()) << told(labels);
}

// Without its actuators nothing tells the square table from itself, turned by 90°.
TEST(Labels, ThatTheBodyMakesAlikeAreNotClaimed) {
  auto made = case_of("table", "none", -1, 1);
  made.mixed.inputs.clear();
  made.mixed.input_shapes.resize(0, made.mixed.count());
  made.mixed.input_std.resize(0, made.mixed.count());
  made.mixed.scaled = false;
  auto alone = believed("table");
  alone.inputs = part_of(alone.inputs, {});
  alone.residual.resize(alone.output_count(), 0);
  const auto labels = labels_of(alone, made.mixed, {});
  EXPECT_TRUE(labels.causes.empty()) << told(labels);
  ASSERT_EQ(labels.notes.size(), 1U);
  EXPECT_NE(labels.notes.front().find("labels of sensors are mixed"), std::string::npos);
}

TEST(Labels, AreNotSoughtByTwoModes) {
  auto made = case_of("ell", "none", -1, 8);
  auto& modes = made.mixed;
  for (auto* vector :
       {&modes.frequency_hz, &modes.frequency_std, &modes.damping_ratio, &modes.damping_std}) {
    vector->conservativeResize(2);
  }
  for (auto* shapes : {&modes.output_shapes, &modes.input_shapes}) {
    shapes->conservativeResize(Eigen::NoChange, 2);
  }
  for (auto* std : {&modes.output_std, &modes.input_std}) {
    std->conservativeResize(Eigen::NoChange, 2);
  }
  EXPECT_TRUE(labels_of(believed("ell"), modes, {}).causes.empty());
}

// One half counts the permutations that move so many, the other half all of them.
TEST(LabelOrders, HaveThePriorOfTheirNumber) {
  const auto prior = [](std::vector<Index> channels) {
    LabelOrder order;
    order.sign.assign(channels.size(), 1.0);
    order.channel_of = std::move(channels);
    return 2.0 * std::exp(log_prior(order)) / kConstants.mixed_prior;
  };
  EXPECT_NEAR(prior({1, 2, 0}), 1.0 / 2.0 / 2.0 + 1.0 / 6.0, 1e-12);
  EXPECT_NEAR(prior({1, 0, 2, 3}), 1.0 / 3.0 / 6.0 + 1.0 / 24.0, 1e-12);
  EXPECT_NEAR(prior({1, 2, 0, 3}), 1.0 / 3.0 / 8.0 + 1.0 / 24.0, 1e-12);
  EXPECT_NEAR(prior({1, 0, 3, 2}), 1.0 / 3.0 / 9.0 + 1.0 / 24.0, 1e-12);
  EXPECT_EQ(prior({0, 1, 2, 3}), 2.0 / kConstants.mixed_prior);
}

// The factorial of 171 is no double number; that of 170 is.
TEST(LabelOrders, HaveAPriorWhereHundredsOfRecordsAreMoved) {
  double before = 0.0;
  for (const std::size_t channels : {169U, 170U, 171U, 172U, 400U}) {
    LabelOrder order;
    order.sign.assign(channels, 1.0);
    for (std::size_t i = 0; i < channels; ++i) {
      order.channel_of.push_back(static_cast<Index>((i + 1) % channels));
    }
    const auto n = static_cast<double>(channels);
    // All are moved: one of n - 1 numbers, and n! / e permutations; beside one of all n!.
    const double few = 1.0 - std::log(n - 1.0) - std::lgamma(n + 1.0);
    const double all = -std::lgamma(n + 1.0);
    const double found = log_prior(order) - std::log(0.5 * kConstants.mixed_prior);
    EXPECT_NEAR(found, few + std::log1p(std::exp(all - few)), 1e-9 * std::abs(few)) << channels;
    EXPECT_LT(found, before);
    before = found;
  }
}

// --- The whole diagnosis.

TEST(DiagnosedLabels, AreACauseOfEachExplanation) {
  EVERY_FOURTH_LANDING();
  const auto made = case_of("ell", "sensor_sign", 4, 11);
  DiagnosisOptions options;
  options.most_causes = 2;
  options.only = {"permuted_sensors", "sensor_sign", "sensor_gain", "youngs_modulus"};
  const auto found = diagnosed(believed("ell"), made.mixed, options);
  EXPECT_EQ(found.verdict, Verdict::named);
  ASSERT_EQ(found.best.causes.size(), 2U);
  EXPECT_EQ(found.best.causes[0].effect, "sensor_sign");
  EXPECT_EQ(found.best.causes[1].effect, "permuted_sensors");
  ASSERT_FALSE(found.rivals.empty());
  for (const auto& rival : found.rivals) EXPECT_EQ(rival.causes.back().effect, "permuted_sensors");
  options.only = {"sensor_sign", "sensor_gain"};
  const auto without = diagnosed(believed("ell"), made.mixed, options);
  for (const auto& cause : without.best.causes) EXPECT_NE(cause.effect, "permuted_sensors");
}

TEST(DiagnosedLabels, AreNamedAloneWhereTheModelIsRight) {
  EVERY_FOURTH_LANDING();
  const auto made = case_of("disc", "none", -1, 12);
  DiagnosisOptions options;
  options.most_causes = 1;
  options.only = {"permuted_sensors", "sensor_sign", "swapped_sensors"};
  const auto found = diagnosed(believed("disc"), made.mixed, options);
  EXPECT_EQ(found.verdict, Verdict::named);
  ASSERT_EQ(found.best.causes.size(), 1U);
  EXPECT_GT(found.best.log_evidence, 100.0);
  double before = 0.0;
  double after = 0.0;
  for (const auto& mode : found.modes) {
    before += mode.mac_before / static_cast<double>(found.modes.size());
    after += mode.mac_after / static_cast<double>(found.modes.size());
  }
  EXPECT_LT(before + 0.2, after);
}

// Records s1, s2, s3 are the sensors s2, s3, s1.
Labels three_mixed() {
  Labels labels;
  labels.causes.resize(1);
  labels.causes.front().effect = "permuted_sensors";
  labels.causes.front().channels = {"s1", "s2", "s3"};
  labels.causes.front().truly = {"s2", "s3", "s1"};
  labels.log_evidence = 100.0;
  return labels;
}

// A cause of relabelled data beside the labels, as a diagnosis tells it.
Cause beside_labels(const std::string& effect, const std::vector<std::string>& channels) {
  Diagnosis diagnosis;
  diagnosis.best.causes.resize(1);
  diagnosis.best.causes.front().effect = effect;
  diagnosis.best.causes.front().channels = channels;
  add(three_mixed(), diagnosis);
  return diagnosis.best.causes.front();
}

TEST(AddedLabels, LetACauseOfARecordNameTheRecord) {
  using Names = std::vector<std::string>;
  for (const auto* name : {"sensor_gain", "sensor_sign", "sensor_unit", "sensor_delay"}) {
    EXPECT_EQ(beside_labels(name, {"s1"}).channels, Names{"s3"}) << name;
    EXPECT_EQ(beside_labels(name, {"s4"}).channels, Names{"s4"}) << name;
  }
  for (const auto* name : {"sensor_position", "sensor_direction", "actuator_gain"}) {
    EXPECT_EQ(beside_labels(name, {"s1"}).channels, Names{"s1"}) << name;
  }
  const Names pair{"s1", "s2"};
  for (const auto* name : {"swapped_sensors", "sensor_crosstalk"}) {
    EXPECT_EQ(beside_labels(name, pair).channels, pair) << name;
  }
  const Names all{"s1", "s2", "s3", "s4"};
  EXPECT_EQ(beside_labels("sensor_unit", all).channels, all);
}

// The causes together predict the records: each row is that of the channel that it shows.
TEST(AddedLabels, PredictWhatTheRelabelledDataHad) {
  const auto& plate = small_plate();
  const Eigen::VectorXd hz = some_lines() / 6.283185307179586;
  const std::vector<std::pair<std::string, std::string>> kinds{
      {"sensor_gain", "relative"}, {"sensor_delay", "delay"}, {"sensor_position", "u"}};
  for (const auto& [effect, number] : kinds) {
    Diagnosis diagnosis;
    auto& causes = diagnosis.best.causes;
    causes.resize(1);
    causes[0].effect = effect;
    causes[0].channels = {"s1"};
    causes[0].parameters = {{number, "", 3e-4, 0.0}, {"v", "m", 0.0, 0.0}};
    const auto relabelled = predicted(plate, causes, hz);
    add(three_mixed(), diagnosis);
    const auto records = predicted(plate, causes, hz);
    for (std::size_t k = 0; k < records.size(); ++k) {
      for (const auto& [record, channel] : {std::pair{0, 1}, {1, 2}, {2, 0}, {3, 3}}) {
        const auto expected = relabelled[k].row(channel);
        EXPECT_LT((records[k].row(record) - expected).norm(), 1e-12 * expected.norm()) << effect;
      }
    }
  }
}

}  // namespace
}  // namespace chladni::diagnosis
