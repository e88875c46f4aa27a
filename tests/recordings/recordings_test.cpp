// Recordings that are read period by period give what they give as a whole, to the last bit.
#include "recordings/recordings.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "recordings/closed_loop.h"
#include "tests/recordings/rigs.h"
#include "tests/refusal.h"

namespace chladni::recordings {
namespace {

using Eigen::Index;

/// How recordings were read.
struct Reading {
  Index most = 0;  ///< samples at a time
  Index all = 0;
};

Recordings in_pieces(const TimeData& data, Reading& reading) {
  auto recordings = recordings_of(data);
  recordings.samples = [whole = recordings.samples, &reading](
                           std::size_t record, Side side, Index channel, Index first, Index count) {
    reading.most = std::max(reading.most, count);
    reading.all += count;
    return whole(record, side, channel, first, count);
  };
  return recordings;
}

FrfEstimateOptions options_with(bool remove_transient) {
  FrfEstimateOptions options;
  options.remove_transient = remove_transient;
  return options;
}

TimeData recorded_data(Index realisations, Index periods) {
  auto rig = rig_of(two_modes(), 512.0);
  rig.sensor_noise = Eigen::Vector2d(1e-5, 2e-5);
  auto plan = plan_of_seconds(periods);
  plan.multisine.lines = ExcitedLines::odd_with_detection;
  return virtual_experiment(rig, plan, static_cast<int>(realisations), 3);
}

void expect_same(const FrfEstimate& found, const FrfEstimate& whole) {
  EXPECT_EQ(found.set.frequency_hz, whole.set.frequency_hz);
  EXPECT_EQ(found.set.value, whole.set.value);
  EXPECT_EQ(found.set.variance, whole.set.variance);
  EXPECT_EQ(found.set.noise_variance, whole.set.noise_variance);
  EXPECT_EQ(found.set.averages, whole.set.averages);
  EXPECT_EQ(found.dropped, whole.dropped);
  EXPECT_EQ(found.periods, whole.periods);
  EXPECT_EQ(found.realisations, whole.realisations);
  EXPECT_EQ(found.notes, whole.notes);
}

TEST(Recordings, GiveTheSameEstimatePeriodByPeriod) {
  for (const bool remove : {true, false}) {
    for (const Index realisations : {1, 3}) {
      const auto data = recorded_data(realisations, 6);
      const auto options = options_with(remove);
      Reading reading;
      const auto found = periodic_estimate(in_pieces(data, reading), options);
      EXPECT_EQ(reading.most, data.period);
      const auto whole = frf_estimate(data, options);
      expect_same(found.estimate, whole);
      const auto all = spectra(data);
      const auto drop = first_steady_period(whole);
      const auto levels = detection_levels(all, drop);
      ASSERT_EQ(found.detection.has_value(), levels.has_value());
      ASSERT_TRUE(levels.has_value());
      EXPECT_EQ(found.detection->level, levels->level);
      EXPECT_EQ(found.detection->noise, levels->noise);
      EXPECT_EQ(found.detection->odd_db, levels->odd_db);
    }
  }
}

TEST(Recordings, GiveTheSameEstimateInALoop) {
  auto data = recorded_data(2, 4);
  data.references = channels("r", 2);
  for (auto& record : data.records) {
    record.references = record.inputs;
    record.inputs.col(0) += 0.3 * record.outputs.col(0);
  }
  for (const bool remove : {true, false}) {
    const auto options = options_with(remove);
    Reading reading;
    expect_same(periodic_estimate(in_pieces(data, reading), options).estimate,
                closed_loop_estimate(data, options).estimate);
    EXPECT_EQ(reading.most, data.period);
  }
}

TEST(Recordings, WantAReferenceForEachInputAsTheWholeDoes) {
  for (const Index references : {1, 3}) {
    auto data = recorded_data(1, 4);
    data.references = channels("r", references);
    for (auto& record : data.records) {
      record.references = record.inputs.col(0).replicate(1, references);
    }
    for (const bool remove : {true, false}) {
      const auto options = options_with(remove);
      Reading reading;
      const auto found =
          refusal_of([&] { return periodic_estimate(in_pieces(data, reading), options); });
      EXPECT_NE(found.find("references for 2 inputs"), std::string::npos) << found;
      EXPECT_EQ(found, refusal_of([&] { return closed_loop_estimate(data, options); }));
    }
  }
}

// Without outputs, or without inputs.
TEST(Recordings, OfOneSideAreRefusedByItsName) {
  for (const bool no_outputs : {true, false}) {
    auto data = recorded_data(1, 4);
    (no_outputs ? data.outputs : data.inputs).clear();
    for (auto& record : data.records) {
      auto& side = no_outputs ? record.outputs : record.inputs;
      side.resize(side.rows(), 0);
    }
    Reading reading;
    const auto found =
        refusal_of([&] { return periodic_estimate(in_pieces(data, reading), options_with(true)); });
    EXPECT_EQ(found.find(no_outputs ? "FRF estimate: no output (sensor)"
                                    : "FRF estimate: no input (force"),
              0U)
        << found;
    EXPECT_EQ(found, refusal_of([&] { return frf_estimate(data, options_with(true)); }));
  }
}

TEST(Recordings, NameTheSameFaults) {
  auto data = recorded_data(3, 4);
  auto& clipped = data.records[2].outputs;
  clipped.col(1) = clipped.col(1).cwiseMin(0.5 * clipped.col(1).maxCoeff());
  auto& lost = data.records[4].inputs;
  const Eigen::MatrixXd rest = lost.bottomRows(lost.rows() - 705);
  lost.middleRows(700, lost.rows() - 705) = rest;
  Reading reading;
  const auto found = recording_faults(in_pieces(data, reading));
  const auto whole = recording_faults(data);
  EXPECT_EQ(reading.most, 4 * 512);
  EXPECT_EQ(found.clipped, whole.clipped);
  EXPECT_EQ(found.lost, whole.lost);
  ASSERT_EQ(found.clipped.size(), 1U);
  ASSERT_EQ(found.lost.size(), 1U);
  EXPECT_NE(found.lost.front().find("record 5: from period 3"), std::string::npos)
      << found.lost.front();
}

TEST(Recordings, NameTheSameTrend) {
  auto data = recorded_data(2, 6);
  for (auto& record : data.records) {
    for (Index n = 0; n < record.outputs.rows(); ++n) {
      record.outputs.row(n) *= 1.0 + 0.06 * static_cast<double>(n / 512) / 5.0;
    }
  }
  Reading reading;
  const auto found = periodic_estimate(in_pieces(data, reading), options_with(true));
  const auto estimate = frf_estimate(data, options_with(true));
  const auto whole = period_drift(excited_part(spectra(data), {}), first_steady_period(estimate));
  ASSERT_FALSE(whole.empty());
  ASSERT_EQ(found.drift.size(), whole.size());
  EXPECT_EQ(found.drift.front().relative, whole.front().relative);
  EXPECT_EQ(found.drift.front().excess, whole.front().excess);
}

}  // namespace
}  // namespace chladni::recordings
