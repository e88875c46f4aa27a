// How good recordings are: faults that are hidden in them are named.
#include <gtest/gtest.h>

#include <cmath>

#include "recordings/data_quality.h"
#include "recordings/frf_estimate.h"
#include "recordings/virtual_experiment.h"

namespace chladni::recordings {
namespace {

VirtualRig one_mode() {
  modal::ReducedModel model;
  model.frequency_hz = Eigen::VectorXd::Constant(1, 20.0);
  model.damping_ratio = Eigen::VectorXd::Constant(1, 0.05);
  model.output_shapes = Eigen::MatrixXd::Ones(1, 1);
  model.input_shapes = Eigen::MatrixXd::Ones(1, 1);
  model.residual.setZero(1, 1);
  VirtualRig rig;
  rig.plant = plant(model);
  rig.outputs.resize(1);
  rig.outputs[0].name = "y1";
  rig.inputs.resize(1);
  rig.inputs[0].name = "u1";
  rig.sample_time_s = 1.0 / 256.0;
  rig.sensor_noise = Eigen::VectorXd::Constant(1, 2e-6);
  return rig;
}

TimeData recorded_on(const VirtualRig& rig, ExcitedLines lines = ExcitedLines::all,
                     int realisations = 2) {
  VirtualExperimentPlan plan;
  plan.multisine.period = 512;
  plan.multisine.sample_time_s = rig.sample_time_s;
  plan.multisine.low_hz = 1.0;
  plan.multisine.high_hz = 60.0;
  plan.multisine.lines = lines;
  plan.periods = 6;
  plan.warm_up = 6;
  return virtual_experiment(rig, plan, realisations, 5);
}

TEST(RecordingFaults, SoundRecordingsHaveNone) {
  auto rig = one_mode();
  for (const double step : {0.0, 1e-6, 1e-5}) {
    rig.quantisation = Eigen::VectorXd::Constant(1, step);
    const auto faults = recording_faults(recorded_on(rig));
    EXPECT_TRUE(faults.clipped.empty()) << step << faults.clipped.front();
    EXPECT_TRUE(faults.lost.empty());
  }
}

TEST(RecordingFaults, NamesTheChannelThatClips) {
  auto data = recorded_on(one_mode());
  for (auto& record : data.records) {
    const double limit = 0.7 * record.outputs.maxCoeff();
    record.outputs = record.outputs.cwiseMin(limit).cwiseMax(-limit);
  }
  const auto faults = recording_faults(data);
  ASSERT_EQ(faults.clipped.size(), 1U);
  EXPECT_NE(faults.clipped.front().find("y1 is clipped at"), std::string::npos);
}

// A range that is not symmetric, or a sensor near its stop, clips at one end.
TEST(RecordingFaults, NamesTheChannelThatClipsAtOneEnd) {
  for (const double end : {1.0, -1.0}) {
    auto data = recorded_on(one_mode());
    for (auto& record : data.records) {
      Eigen::MatrixXd turned = end * record.outputs;
      turned = turned.cwiseMin(0.7 * turned.maxCoeff()).eval();
      record.outputs = end * turned;
    }
    EXPECT_EQ(recording_faults(data).clipped.size(), 1U) << end;
  }
}

// Samples that an acquisition lost: all that follows comes early.
TEST(RecordingFaults, CountsTheSamplesThatWereLost) {
  for (const Eigen::Index lost : {1, 7}) {
    auto data = recorded_on(one_mode());
    auto& record = data.records[1];
    const Eigen::Index at = 2 * 512 + 100;
    const auto rows = record.inputs.rows();
    for (auto* side : {&record.inputs, &record.outputs}) {
      const Eigen::MatrixXd rest = side->middleRows(at + lost, rows - at - lost);
      side->middleRows(at, rows - at - lost) = rest;
    }
    const auto faults = recording_faults(data);
    ASSERT_EQ(faults.lost.size(), 1U);
    EXPECT_NE(faults.lost.front().find("record 2: from period"), std::string::npos);
    EXPECT_NE(faults.lost.front().find(std::to_string(lost) + " samples early"), std::string::npos)
        << faults.lost.front();
  }
}

// A mean is alike in any place: it tells nothing of where a period is, nor which channel excites.
TEST(RecordingFaults, CountsTheSamplesThatWereLostBesideAMean) {
  auto data = recorded_on(one_mode());
  data.inputs.resize(2);
  data.inputs[1].name = "supply";
  const double mean = 100.0 * data.records.front().inputs.cwiseAbs().maxCoeff();
  for (auto& record : data.records) {
    record.inputs.conservativeResize(Eigen::NoChange, 2);
    record.inputs.col(0).array() += mean;
    record.inputs.col(1).setConstant(7.3 * mean);
  }
  EXPECT_TRUE(recording_faults(data).lost.empty());
  auto& inputs = data.records[1].inputs;
  const Eigen::Index at = 2 * 512 + 100;
  const Eigen::MatrixXd rest = inputs.bottomRows(inputs.rows() - at - 7);
  inputs.middleRows(at, rest.rows()) = rest;
  const auto faults = recording_faults(data);
  ASSERT_EQ(faults.lost.size(), 1U);
  EXPECT_NE(faults.lost.front().find("7 samples early"), std::string::npos) << faults.lost.front();
  // What is constant excites nothing, and is nowhere out of place.
  for (auto& record : data.records) record.inputs.col(0).setConstant(mean / 3.0);
  EXPECT_TRUE(recording_faults(data).lost.empty());
}

TEST(DataQuality, HasNoBandWithoutResponses) {
  auto set = frf_estimate(recorded_on(one_mode())).set;
  set.outputs.clear();
  for (auto* lines : {&set.variance, &set.noise_variance}) {
    for (auto& line : *lines) line.resize(0, 1);
  }
  for (auto& line : set.value) line.resize(0, 1);
  EXPECT_TRUE(band_qualities(set).empty());
  EXPECT_EQ(trusted_bands(set, band_qualities(set)), "");
}

TEST(DataQuality, TrustsTheBandWhereTheResponseStandsOutOfTheNoise) {
  const auto estimate = frf_estimate(recorded_on(one_mode(), ExcitedLines::all, 6));
  const auto bands = band_qualities(estimate.set);
  ASSERT_GE(bands.size(), 3U);
  EXPECT_EQ(bands.front().low_hz, estimate.set.frequency_hz(0));
  EXPECT_EQ(bands.back().high_hz, estimate.set.frequency_hz.tail(1)(0));
  Eigen::Index lines = 0;
  for (const auto& band : bands) lines += band.lines;
  EXPECT_EQ(lines, estimate.set.line_count());
  // The receptance falls by a factor of 8 above its mode: so does what stands out of the noise.
  EXPECT_GT(bands.back().deviation(0), 3.0 * bands.front().deviation(0));
  EXPECT_NE(trusted_bands(estimate.set, bands).find("from 1 to"), std::string::npos);
}

// A cubic spring distorts oddly: odd silent lines show it, even ones do not.
TEST(DetectionLines, SeparateOddFromEvenDistortion) {
  auto rig = one_mode();
  const auto linear =
      detection_levels(spectra(recorded_on(rig, ExcitedLines::odd_with_detection), 1.0, 60.0), 1);
  ASSERT_TRUE(linear.has_value());
  EXPECT_LT(linear->odd_db(0), linear->noise_db(0));
  EXPECT_LT(linear->even_db(0), linear->noise_db(0));
  rig.sensor_noise.setConstant(1e-8);
  rig.spring = CubicSpring{.stiffness = 1e10, .output = 0, .input = 0};
  const auto cubic =
      detection_levels(spectra(recorded_on(rig, ExcitedLines::odd_with_detection), 1.0, 60.0), 1);
  ASSERT_TRUE(cubic.has_value());
  EXPECT_GT(cubic->odd_db(0), cubic->noise_db(0) + 10.0);
  EXPECT_LT(cubic->even_db(0), cubic->odd_db(0) - 20.0);
  // And a bent spring, y + a y², evenly.
  auto data = recorded_on(one_mode(), ExcitedLines::odd_with_detection);
  const double size = data.records.front().outputs.cwiseAbs().maxCoeff();
  for (auto& record : data.records) {
    record.outputs.array() += 0.1 * record.outputs.array().square() / size;
  }
  const auto even = detection_levels(spectra(data, 1.0, 60.0), 1);
  EXPECT_GT(even->even_db(0), even->odd_db(0) + 10.0);
  EXPECT_FALSE(detection_levels(spectra(recorded_on(one_mode()), 1.0, 60.0), 1).has_value());
}

// All realisations are silent on the same lines, so that a response is known on all others.
TEST(DetectionLines, LeaveTheEstimateOnTheExcitedLinesSound) {
  const auto rig = one_mode();
  const auto estimate = frf_estimate(recorded_on(rig, ExcitedLines::odd_with_detection, 5));
  EXPECT_GT(estimate.set.line_count(), 35);
  for (const auto& value : estimate.set.value) EXPECT_LT(std::abs(value(0, 0)), 1e-2);
}

TEST(PeriodDrift, IsSeenAndSized) {
  auto data = recorded_on(one_mode());
  const FrfEstimateOptions options;
  EXPECT_TRUE(period_drift(excited_part(spectra(data), options), 1).empty());
  for (auto& record : data.records) {
    for (Eigen::Index n = 0; n < record.outputs.rows(); ++n) {
      record.outputs.row(n) *= 1.0 + 0.06 * static_cast<double>(n / 512) / 5.0;
    }
  }
  const auto drift = period_drift(excited_part(spectra(data), options), 1);
  ASSERT_EQ(drift.size(), 1U);
  EXPECT_NEAR(drift.front().relative, 0.06 * 4.0 / 5.0, 0.01);  // from the second period on
}

TEST(PeriodDrift, IsNotThatOfAnOutputOfZeros) {
  auto data = recorded_on(one_mode());
  data.outputs.resize(2);
  data.outputs[1].name = "dead";
  for (auto& record : data.records) {
    record.outputs.conservativeResize(Eigen::NoChange, 2);
    record.outputs.col(1).setZero();
  }
  EXPECT_TRUE(period_drift(excited_part(spectra(data), {}), 1).empty());
}

}  // namespace
}  // namespace chladni::recordings
